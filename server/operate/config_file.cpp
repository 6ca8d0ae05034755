#include "server/operate/config_file.h"

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/nearest.h"
#include "common/toml_text.h"

namespace brume {
namespace {

// Empty: the environment says nothing.
std::string environmentValue(const CLI::Option& option) {
    const char* value = option.get_configurable() ? std::getenv(environmentName(option).c_str()) : nullptr;
    return value ? value : "";
}

bool isFlag(const CLI::Option& option) { return option.get_expected_min() == 0; }
bool takesSeveral(const CLI::Option& option) {
    return !isFlag(option) && option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
}

// The words that CLI11 would find on a command line; nothing for what is no single value.
std::optional<std::string> wordOf(const toml::node& node) {
    if (auto text = node.value_exact<std::string>()) return text;
    if (const auto truth = node.value_exact<bool>()) return *truth ? "true" : "false";
    if (const auto whole = node.value_exact<int64_t>()) return std::to_string(*whole);
    if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
    return {};
}

std::string quoted(const std::string& text) {
    std::ostringstream out;
    const toml::value<std::string> value(text);
    out << toml::toml_formatter(value, toml::format_flags::allow_unicode_strings); // one line, escaped
    return out.str();
}

// As it is where TOML reads this very number or truth value, else in quotes.
std::string tomlWord(const std::string& word) {
    try {
        const toml::table table = parseToml("v = " + word);
        const toml::node* value = table.get("v");
        if (table.size() == 1 && (value->is_number() || value->is_boolean()) && wordOf(*value) == word) return word;
    } catch (const toml::parse_error&) {
    }
    return quoted(word);
}

// "--port" in "--port: 70000 is not allowed here", but not in "--port-name: ...".
bool names(const std::string& complaint, const std::string& option) {
    const size_t at = complaint.find(option);
    if (at == complaint.npos) return false;
    const char next = at + option.size() < complaint.size() ? complaint[at + option.size()] : ' ';
    return next != '-' && !std::isalnum(static_cast<unsigned char>(next));
}

std::vector<std::string> configurableKeys(const CLI::App& app) {
    std::vector<std::string> keys;
    for (const CLI::Option* option : app.get_options({}))
        if (option->get_configurable()) keys.push_back(option->get_single_name());
    return keys;
}

} // namespace

std::string environmentName(const CLI::Option& option) {
    std::string name = "BRUME_" + option.get_single_name();
    std::transform(name.begin(), name.end(), name.begin(), [](char c) {
        return c == '-' ? '_' : c >= 'a' && c <= 'z' ? char(c - 'a' + 'A') : c;
    });
    return name;
}

void takeEnvironment(CLI::App& app) {
    for (CLI::Option* option : app.get_options({})) {
        const std::string value = environmentValue(*option);
        if (value.empty() || option->count() > 0) continue;
        try {
            option->add_result(value);
            option->run_callback();
        } catch (const CLI::ParseError& error) {
            throw CLI::ConfigError(fmt::format("environment {}: {}", environmentName(*option), error.what()),
                                   CLI::ExitCodes::ConfigError);
        }
    }
}

void showEnvironment(CLI::App& app) {
    for (CLI::Option* option : app.get_options({}))
        if (option->get_configurable()) option->envname(environmentName(*option));
}

std::string ConfigFile::file() const { return app_.get_config_ptr()->as<std::string>(); }

std::vector<CLI::ConfigItem> ConfigFile::from_config(std::istream& in) const {
    const auto fail = [&](size_t line, const std::string& what) {
        return CLI::ConfigError(fmt::format("{}:{}: {}", file(), line, what), CLI::ExitCodes::ConfigError);
    };
    toml::table root;
    try {
        const std::string text{std::istreambuf_iterator<char>(in), {}};
        root = parseToml(text, file());
    } catch (const toml::parse_error& error) {
        throw fail(error.source().begin.line, syntaxProblem(error));
    }
    std::vector<CLI::ConfigItem> found;
    for (const auto& [toml_key, node] : root) {
        const std::string key(toml_key.str());
        const size_t line = node.source().begin.line;
        const CLI::Option* option = app_.get_option_no_throw("--" + key);
        if (!option || !option->get_configurable())
            throw fail(line, fmt::format("{}: no such key{}; allowed: those that brume-server --print-config prints",
                                         key, didYouMean(key, configurableKeys(app_))));
        CLI::ConfigItem item{{}, key, {}};
        const toml::array* list = node.as_array();
        if (list && takesSeveral(*option))
            for (const toml::node& element : *list) {
                const auto word = wordOf(element);
                if (!word) throw fail(line, fmt::format("{}: allowed: an array of strings", key));
                item.inputs.push_back(*word);
            }
        else if (const auto word = wordOf(node))
            item.inputs = {*word};
        else
            throw fail(line, fmt::format("{}: allowed: one value{}", key,
                                         takesSeveral(*option) ? ", or an array of them" : ""));
        if (isFlag(*option) && !node.is_boolean()) throw fail(line, fmt::format("{}: allowed: true or false", key));
        if (item.inputs.empty() || option->count() > 0 || !environmentValue(*option).empty()) continue;
        lines_[key] = line;
        found.push_back(std::move(item));
    }
    return found;
}

std::string ConfigFile::sourceOf(const std::string& complaint) const {
    for (const auto& [key, line] : lines_)
        if (names(complaint, "--" + key)) return fmt::format("{}:{}: ", file(), line);
    return {};
}

std::vector<std::string> valuesOf(const CLI::Option& option) {
    if (option.count() > 0) return option.reduced_results();
    const std::string& value = option.get_default_str();
    if (isFlag(option))
        return value.empty() ? std::vector<std::string>{"false"} : std::vector<std::string>{}; // else in words
    if (value.empty() || value == "[]" || value == "{}") return {};
    return {value};
}

std::string tomlOf(const CLI::Option& option) {
    const std::vector<std::string> values = valuesOf(option);
    if (!takesSeveral(option)) return values.empty() ? "" : tomlWord(values.front());
    std::vector<std::string> words;
    for (const std::string& value : values) words.push_back(quoted(value));
    return fmt::format("[{}]", fmt::join(words, ", "));
}

std::string writeConfig(const CLI::App& app) {
    std::string out =
        "# brume-server: every option as it stands. A flag goes before the environment, that before this file.\n";
    for (const std::string& group : app.get_groups()) {
        std::string lines;
        for (const CLI::Option* option : app.get_options({})) {
            if (!option->get_configurable() || option->get_group() != group) continue;
            const std::string value = tomlOf(*option);
            lines += fmt::format("\n# {}\n", option->get_description());
            if (!isFlag(*option)) lines += fmt::format("# {}\n", option->get_type_name());
            lines += fmt::format("{}{} ={}{}\n", value.empty() ? "# " : "", option->get_single_name(),
                                 value.empty() ? "" : " ", value);
        }
        if (!lines.empty()) out += fmt::format("\n# --- {} ---\n{}", group, lines);
    }
    return out;
}

} // namespace brume
