// Views: pictures of how the picture is made, by the names that queries, messages and options use.
#pragma once

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

namespace brume {

// In the order of gpu::kShowPicture and so on (shaders/shared/show.h).
inline constexpr std::string_view kViewNames[] = {"picture", "wasted", "overdraw", "particles", "rays",
                                                  "depth",   "shadow", "light",    "error"};

// The view's number; nothing: there is no view of that name.
constexpr std::optional<uint8_t> viewNamed(std::string_view name) {
    const auto at = std::ranges::find(kViewNames, name);
    if (at == std::end(kViewNames)) return {};
    return uint8_t(at - std::begin(kViewNames));
}
// All names, for a line that says what is allowed.
inline std::string allViewNames() {
    std::string all;
    for (const std::string_view name : kViewNames) all += (all.empty() ? "" : " ") + std::string(name);
    return all;
}

} // namespace brume
