// Views of how a picture is made, which are drawn in its place (show.comp). One text, compiled as C++ and as GLSL.
#ifndef BRUME_SHARED_SHOW_H
#define BRUME_SHARED_SHOW_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
namespace brume::gpu {
using uint = uint32_t;
using glm::uvec2;
using glm::vec2;
#endif

// Eye::show. Their names: common/view_names.h.
const uint kShowPicture = 0u;
const uint kShowWasted = 1u;    // the part of the tetrahedra on a pixel whose optical depth there is below the cut
const uint kShowOverdraw = 2u;  // number of proxies that cover a pixel
const uint kShowParticles = 3u; // number of particles that reach a tile of kShowTile x kShowTile pixels
const uint kShowRays = 4u;      // the lattice of rays, and on each the number of slabs that particles reach
const uint kShowDepth = 5u;     // optical depth of the particles in front of the surface
const uint kShowShadow = 6u;    // the planes of the sun's volumetric shadow map, side by side
const uint kShowLight = 7u;     // particles as discs, with the part of the sun's light that arrives at their centres
const uint kShowError = 8u;     // error of measured pixels
const uint kShows = 9u;

const uint kShowTile = 16u; // pixels

// A pixel whose error was measured.
struct ErrorDisc {
    vec2 at;     // middle of the pixel, in parts of the picture's width and height
    float error; // relative: length of (drawn - reference) / length of the reference
};
const uint kMostErrorDiscs = 1024u;

struct ShowPush {
    uint items;      // number of particles that are asked, or of error discs
    uint every;      // one particle in so many is asked, for all of them
    uint step;       // pixels along a side of a square that one is computed for
    uint spheres;    // 1: proxies are spheres around the full Gaussian, 0: tetrahedra
    uint legend;     // first word of the legend: its pixels, row by row, each as R, G, B, opacity from the low byte on
    uint first_disc; // of its discs
    uvec2 legend_size; // pixels; 0: there is none
    uint legend_scale; // pixels of the picture for one of the legend
};

#ifdef __cplusplus
} // namespace brume::gpu
#endif

#endif
