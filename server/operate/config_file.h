// ConfigFile: reads a program's options from a TOML file. toml++ parses it, CLI11 checks and stores the values.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace brume {

// The file has one key for every option: --max-viewers 8 is max-viewers = 8. An option that may be given several
// times is an array. A flag overrides the environment (takeEnvironment() below), which overrides the file.
class ConfigFile final : public CLI::ConfigTOML {
public:
    explicit ConfigFile(const CLI::App& app) : app_(app) {}

    // Returns the values of options that neither the command line nor the environment sets. Throws CLI::ConfigError
    // for bad syntax, an unknown key, or a table in place of a value. Its text is one line with file, line, key and
    // what is allowed.
    std::vector<CLI::ConfigItem> from_config(std::istream& in) const override;

    // `complaint`: an error text of CLI11 that names an option. Returns "FILE:LINE: " if the file set that option,
    // otherwise empty.
    std::string sourceOf(const std::string& complaint) const;

private:
    std::string file() const;

    const CLI::App& app_;
    mutable std::map<std::string, size_t> lines_; // line of each key whose value was taken
};

// The present value of an option, as its strings; empty if it has none.
std::vector<std::string> valuesOf(const CLI::Option& option);
// The present value of an option as TOML: numbers and booleans bare, all others quoted.
std::string tomlOf(const CLI::Option& option);

// Writes such a file with all options, their values and descriptions. An option without a value is commented out.
std::string writeConfig(const CLI::App& app);

// Name of an option's environment variable: BRUME_MAX_VIEWERS for --max-viewers.
std::string environmentName(const CLI::Option& option);
// To be called after parse(): sets every option without a flag from its environment variable. CLI11 could do so
// itself (envname), but newer versions ignore a value that an option refuses. Throws CLI::ConfigError, one line, for
// such a value.
void takeEnvironment(CLI::App& app);
// Adds the names of the environment variables to the help text.
void showEnvironment(CLI::App& app);

} // namespace brume
