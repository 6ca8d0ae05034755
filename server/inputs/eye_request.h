// One picture that is asked for.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "common/camera.h"
#include "shaders/shared/show.h"

namespace brume {

inline constexpr float kNearDepth = 0.05f; // m, view depth in front of which nothing is drawn

struct EyeRequest {
    Pose pose;
    uint32_t width = 0, height = 0; // pixels
    bool second = false;            // True: the right eye of a head whose left eye is the request before it
    uint32_t rate = 0;    // pixels between rays in this picture, for methods that have rays; 0: RenderSettings::rate
    uint64_t history = 0; // a number of the eye's own, by which pictures of it find its last one; 0: it has none
    uint32_t depth_layers = 0;              // that are drawn besides (shared/depth_layers.h); 0: none
    uint32_t show = gpu::kShowPicture;      // what is drawn in place of the picture
    std::span<const gpu::ErrorDisc> errors; // for gpu::kShowError; valid until the submission
};

// Pixels of the largest picture.
inline uint64_t mostPixels(std::span<const EyeRequest> eyes) {
    uint64_t most = 0;
    for (const EyeRequest& eye : eyes) most = std::max(most, uint64_t{eye.width} * eye.height);
    return most;
}

} // namespace brume
