// Legends of views (shaders/shared/show.h): what a view shows, and its colours with numbers, as small pictures.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "shaders/shared/show.h"

namespace brume {

// What is written under a bar of colours. Without ticks there is no bar.
struct Legend {
    uint32_t show; // gpu::kShowWasted and so on
    std::string_view title;
    struct Tick {
        double value; // on the view's scale (shaders/shared/show_colours.h)
        std::string_view text;
    };
    std::span<const Tick> ticks;
};

// Of a view there are several where the scene or the method decides what it shows.
enum class LegendOf : uint32_t {
    wasted,
    overdraw_tetrahedra,
    overdraw_spheres,
    particles,
    rays,
    no_rays,
    no_gaussians,
    depth,
    shadow,
    no_sun_shadow,
    light,
    no_sun_light,
    error,
    no_error
};
inline constexpr uint32_t kLegends = uint32_t(LegendOf::no_error) + 1;
const Legend& legendOf(LegendOf which);

// A legend's pixels, row by row: R, G, B and opacity, a byte each from the low one on.
struct LegendPicture {
    glm::uvec2 size{0};
    std::vector<uint32_t> pixels;
};
// Characters that the font lacks stay empty: it has capitals, digits and some marks.
LegendPicture drawLegend(const Legend& legend);

} // namespace brume
