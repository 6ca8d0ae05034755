#include "common/nearest.h"

#include <algorithm>
#include <array>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace brume {
namespace {

constexpr size_t kLongest = 64;
constexpr size_t kLeastBeginning = 4; // bytes that are taken for the beginning of a name

// How many letters are put in, left out, replaced or exchanged with their neighbour (optimal string alignment).
size_t editDistance(std::string_view a, std::string_view b) {
    std::array<std::array<size_t, kLongest + 1>, kLongest + 1> d{};
    for (size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (size_t i = 1; i <= a.size(); ++i)
        for (size_t j = 1; j <= b.size(); ++j) {
            d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

size_t wrongLetters(std::string_view word, std::string_view name) {
    if (word.size() >= kLeastBeginning && name.starts_with(word)) return 1;
    const size_t whole = editDistance(word, name), dot = name.rfind('.');
    return dot == name.npos ? whole : std::min(whole, editDistance(word, name.substr(dot + 1)));
}

} // namespace

std::string didYouMean(std::string_view word, std::span<const std::string> names) {
    if (word.size() > kLongest) return {};
    size_t least = std::max<size_t>(word.size() / 3, 1);
    std::vector<std::string_view> nearest;
    for (const std::string& name : names) {
        if (name.size() > kLongest) continue;
        const size_t wrong = wrongLetters(word, name);
        if (wrong > least) continue;
        if (wrong < least) nearest.clear();
        least = wrong;
        nearest.push_back(name);
    }
    if (nearest.empty() || nearest.size() > 3) return {};
    return fmt::format("; did you mean {}?", fmt::join(nearest, " or "));
}

} // namespace brume
