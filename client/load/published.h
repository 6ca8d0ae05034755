// Published costs of rendering for several viewers, to compare with.
#pragma once

#include <array>
#include <optional>

namespace brume::load {

// Stojanovic, Weinrauch, Tatzgern, Kurz, Steinberger: "Efficient Rendering of Participating Media for Multiple
// Viewpoints", 2023, tables 1 to 3: milliseconds of all viewers' media together, 1920x1080 each, on an RTX 3090.
inline constexpr std::array kPublishedViewers{1u, 2u, 3u, 4u, 6u, 8u, 12u, 16u};

struct Published {
    const char* name;
    std::array<double, kPublishedViewers.size()> ms;
};

inline constexpr Published kPublished[] = {
    {"froxels, San Miguel", {1.10, 2.13, 3.17, 4.06, 5.54, 6.94, 10.68, 14.39}},
    {"shared grid, San Miguel 0.125 m", {0.91, 1.57, 2.17, 2.73, 3.57, 4.57, 6.54, 8.57}},
    {"froxels, Bistro", {4.58, 9.44, 13.77, 17.84, 26.53, 34.89, 52.02, 68.86}},
    {"shared grid, Bistro 0.5 m", {4.37, 6.56, 8.96, 11.20, 14.98, 17.88, 22.27, 26.92}},
    {"froxels, Trash God", {2.41, 6.17, 9.53, 19.97, 25.43, 31.87, 45.68, 67.53}},
    {"shared grid, Trash God 0.333 m", {3.64, 5.91, 8.27, 12.88, 15.63, 18.57, 23.70, 30.49}},
};

// Cost of one of `viewers` viewers over the cost of a single viewer; nothing if that number was not published.
constexpr std::optional<double> perViewer(const Published& published, unsigned viewers) {
    for (size_t i = 0; i < kPublishedViewers.size(); ++i)
        if (kPublishedViewers[i] == viewers) return published.ms[i] / (viewers * published.ms[0]);
    return {};
}

} // namespace brume::load
