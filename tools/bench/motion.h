// Pictures in motion: the camera, particles, the sun or a lamp move, and each frame is compared with its own truth.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/bench/truth.h"

namespace brume::bench {

// - camera: goes round the target, or from place to place.
// - particles: they are pushed along the view axis, and the simulation goes on. With the others it is paused.
// - sun: turns about the vertical.
// - lamp: the first point or spot goes round the vertical through its pivot.
// - all: those at once that the scene has.
inline constexpr std::string_view kMovers[]{"camera", "particles", "sun", "lamp", "all"};

// A frame is a tick, 1/60 s.
struct Motion {
    std::vector<std::string> movers{"particles"}; // rows for each
    uint32_t ticks = 0;                           // of simulation before the first frame
    uint32_t lead = 0;               // frames before those that are measured, so that what remembers has something to
    uint32_t frames = 12;            // at least 3
    float degrees = 0;               // a frame, of the camera
    float light_degrees = 0;         // a frame, of the sun and the lamp
    std::vector<std::string> places; // cameras that it goes to evenly, in place of a turn; the first is the case's
    glm::uvec2 size{160, 90};
    uint32_t every = 1;           // only every so many-th pixel is compared, see thinned()
    bool errors = true;           // False: times alone
    std::optional<size_t> beside; // the case whose pictures are the truth; nothing: the reference
};

// A row for each mover and case, with MotionErrors, and mean, deviation and variance of the device's ms; with places
// also of the frames nearest to each. Throws SceneError for a lamp where there is none.
nlohmann::json motionRows(const gpu::Device& device, const std::vector<NamedCase>& cases, const Motion& motion,
                          Truth& truth);

} // namespace brume::bench
