// Measures the time saved by leaving out of the shaders features that a scene does not have.
#pragma once

#include <string>

#include "tools/bench/stage.h"

namespace brume::bench {

// Times each method on the scene cloud, slabs and tiles also on cloud-5000, at 640x360 from outside. These scenes
// have no objects, lobe or ambient light. Each is compiled for what it has, and again with one more feature, `frames`
// frames of each in turns. Returns Markdown. Throws std::runtime_error if a picture changes by more than rounding:
// then the time would not be that of a feature.
std::string featuresTable(const gpu::Device& device, uint32_t frames);
// The same of `slabs` and `grid` on `cloud`, and of what they alone draw: fog, meshes and shafts.
std::string absentFeatures(const gpu::Device& device, uint32_t frames);

} // namespace brume::bench
