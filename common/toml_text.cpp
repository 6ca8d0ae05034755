#include "common/toml_text.h"

#include <algorithm>

namespace brume {
namespace {

constexpr int kMostParts = 16, kMostTables = 16;

// The line where a key may have too many parts or tables may be too deep; 0: none. Text in quotes is looked at as if it
// were not: sixteen dots without a comma, a bracket or an end of line between them stand in no sentence.
uint32_t lineTooDeep(std::string_view text) {
    uint32_t line = 1;
    int dots = 0, tables = 0;
    char before = 0;
    for (const char c : text) {
        if (c == '.')
            dots = before == '.' ? 0 : dots + 1; // no key has an empty part
        else if (c == '{')
            ++tables, dots = 0;
        else if (c == '}')
            tables = std::max(tables - 1, 0), dots = 0;
        else if (c == '\n')
            ++line, dots = 0;
        else if (c == '=' || c == ',' || c == '[' || c == ']' || c == '#')
            dots = 0;
        if (dots >= kMostParts || tables > kMostTables) return line;
        before = c;
    }
    return 0;
}

} // namespace

toml::table parseToml(std::string_view text, const std::string& name) {
    if (const uint32_t line = lineTooDeep(text))
        throw toml::parse_error("more than 16 levels inside each other", toml::source_position{line, 1});
    return toml::parse(text, name);
}

} // namespace brume
