// A program's options as a TOML file: read by toml++, checked and stored by CLI11.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <CLI/App.hpp>

namespace brume {

// One key of the file for every option: --max-viewers 8 is max-viewers = 8; what may be given several times is an array.
class ConfigFile final : public CLI::ConfigTOML {
public:
    explicit ConfigFile(const CLI::App& app) : app_(app) {}

    // Only what neither the command line nor the environment says: they go first. Throws CLI::ConfigError, in one line with file,
    // line, key and what is allowed, on bad syntax, unknown keys, and tables where a value is meant.
    std::vector<CLI::ConfigItem> from_config(std::istream& in) const override;

    // Where the value of the option comes from that `complaint` (of CLI11) names: "FILE:LINE: " or "environment BRUME_X: "; empty
    // when it is the command line's.
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

} // namespace brume
