// Hashes of pictures: every shipped scene, one with several albedos and one of ellipsoids, by every method from two
// cameras. The text stays equal as long as no bit of a picture changes. Compare it before and after a refactoring to
// show that pictures are unchanged.
#pragma once

#include <string>

#include "server/gpu/device.h"

namespace brume::bench {

// One line per picture: scene, camera, method, variant, XXH3 of its bytes. `only`: part of the scenes' names; empty:
// all scenes.
std::string pictureHashes(const gpu::Device& device, const std::string& only);

} // namespace brume::bench
