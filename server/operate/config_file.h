// A program's options as a TOML file: read by toml++, checked and stored by CLI11.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <CLI/App.hpp>

namespace brume {

// One key of the file for every option: --max-viewers 8 is max-viewers = 8; what may be given several times is an array.
// The order in which values count: flags, environment (takeEnvironment() below), file.
class ConfigFile final : public CLI::ConfigTOML {
public:
    explicit ConfigFile(const CLI::App& app) : app_(app) {}

    // Only what neither the command line nor the environment says: they go first. Throws CLI::ConfigError, in one line with file,
    // line, key and what is allowed, on bad syntax, unknown keys, and tables where a value is meant.
    std::vector<CLI::ConfigItem> from_config(std::istream& in) const override;

    // "FILE:LINE: " when the file gave the value of the option that `complaint` (of CLI11) names, else empty.
    std::string sourceOf(const std::string& complaint) const;

private:
    std::string file() const;

    const CLI::App& app_;
    mutable std::map<std::string, size_t> lines_; // of keys whose values were taken from the file
};

// An option's value as it stands: every string of it; empty when it has none.
std::vector<std::string> valuesOf(const CLI::Option& option);
// The same as TOML: numbers and truth values bare, all else quoted.
std::string tomlOf(const CLI::Option& option);

// All options with their values as such a file, with comments; an option without a value is a comment too.
std::string writeConfig(const CLI::App& app);

// BRUME_MAX_VIEWERS for --max-viewers.
std::string environmentName(const CLI::Option& option);
// After parse(): every option that no flag gave takes its environment variable. CLI11 could read them too (envname), but its
// newer versions pass over a value that an option refuses. Throws CLI::ConfigError, in one line, for such a value.
void takeEnvironment(CLI::App& app);
// Help names the variables.
void showEnvironment(CLI::App& app);

} // namespace brume
