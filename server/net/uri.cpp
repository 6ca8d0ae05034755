#include "server/net/uri.h"

#include <algorithm>
#include <charconv>

namespace brume::net {

std::optional<std::string> percentDecode(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            out += text[i];
            continue;
        }
        if (i + 2 >= text.size()) return {};
        unsigned value = 0;
        const char *first = text.data() + i + 1, *last = first + 2;
        if (std::from_chars(first, last, value, 16).ptr != last) return {};
        out += char(value);
        i += 2;
    }
    return out;
}

std::optional<std::map<std::string, std::string, std::less<>>> parseQuery(std::string_view query) {
    std::map<std::string, std::string, std::less<>> out;
    for (size_t begin = 0, end; begin < query.size(); begin = end + 1) {
        end = std::min(query.find('&', begin), query.size());
        const std::string_view pair = query.substr(begin, end - begin);
        if (pair.empty()) continue;
        const size_t equals = std::min(pair.find('='), pair.size());
        auto name = percentDecode(pair.substr(0, equals));
        auto value = percentDecode(pair.substr(std::min(equals + 1, pair.size())));
        if (!name || !value || !out.emplace(*std::move(name), *std::move(value)).second) return {};
    }
    return out;
}

} // namespace brume::net
