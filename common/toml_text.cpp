#include "common/toml_text.h"

#include <algorithm>

namespace brume {
namespace {

constexpr int kMostParts = 16, kMostTables = 16;

// Where what begins at `at` ends: a string with its quotes, or a comment without its end of line. `at` itself where
// neither begins.
size_t endOfText(std::string_view text, size_t at) {
    const char quote = text[at];
    if (quote == '#') return std::min(text.find('\n', at), text.size());
    if (quote != '"' && quote != '\'') return at;
    const auto quotesAt = [&](size_t i) { // how many there are
        size_t count = 0;
        while (i + count < text.size() && text[i + count] == quote) ++count;
        return count;
    };
    const size_t opening = quotesAt(at);
    if (opening == 2) return at + 2; // empty
    const bool lines = opening >= 3;
    for (size_t i = at + (lines ? 3 : 1); i < text.size(); ++i) {
        if (text[i] == '\\' && quote == '"')
            ++i;
        else if (!lines && (text[i] == quote || text[i] == '\n'))
            return i + 1;
        else if (const size_t closing = lines ? quotesAt(i) : 0; closing >= 3)
            return i + std::min<size_t>(closing, 5); // two of them may be the text's
    }
    return text.size();
}

// The first line where a key has too many parts, or tables are too deep; 0: none.
uint32_t lineTooDeep(std::string_view text) {
    uint32_t line = 1;
    int dots = 0, tables = 0;
    for (size_t i = 0; i < text.size(); ++i) {
        if (const size_t end = endOfText(text, i); end > i) {
            line += uint32_t(std::count(text.begin() + ptrdiff_t(i), text.begin() + ptrdiff_t(end), '\n'));
            i = end - 1;
            continue;
        }
        switch (text[i]) {
        case '.':
            ++dots;
            break;
        case '\n':
            ++line, dots = 0;
            break;
        case '{':
            ++tables, dots = 0;
            break;
        case '}':
            tables = std::max(tables - 1, 0), dots = 0;
            break;
        case '=':
        case ',':
        case '[':
        case ']':
            dots = 0;
            break;
        default:
            break;
        }
        if (dots >= kMostParts || tables > kMostTables) return line;
    }
    return 0;
}

} // namespace

toml::table parseToml(std::string_view text, const std::string& name) {
    if (const uint32_t line = lineTooDeep(text))
        throw toml::parse_error("more than 16 levels inside each other", toml::source_position{line, 1});
    return toml::parse(text, name);
}

std::string syntaxProblem(const toml::parse_error& error) {
    const std::string_view said = error.description();
    const auto says = [&](std::string_view part) { return said.find(part) != said.npos; };
    const char* advice = "allowed: TOML 1.0";
    if (says("redefine existing table"))
        advice = "allowed: each table once; put its keys where it stands first";
    else if (says("expected 'nan'") || says("expected 'true'") || says("expected 'false'") || says("expected 'inf'") ||
             says("could not determine value type"))
        advice = "allowed: TOML 1.0, where texts stand in quotes";
    return "syntax: " + std::string(said) + "; " + advice;
}

} // namespace brume
