// What is saved by compiling out of the shaders what a scene does not have.
#pragma once

#include <string>

#include "tools/bench/stage.h"

namespace brume::bench {

// Each method on the scene cloud, slabs and tiles also on cloud-5000, which have no objects, lobe or ambient light, 640x360 from
// outside: compiled for what they have, and for each thing besides that they do not. `frames` frames of each in turns. Markdown.
// Throws std::runtime_error when a picture changes by more than rounding: then something else was measured than what a feature
// costs.
std::string featuresTable(const gpu::Device& device, uint32_t frames);

} // namespace brume::bench
