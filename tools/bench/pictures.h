// Fingerprints of pictures: every shipped scene by every method from two cameras, the same text as long as no bit of any picture
// changes. Written before and after a change of structure and compared, they prove that it changed nothing else.
#pragma once

#include <string>

#include "server/gpu/device.h"

namespace brume::bench {

// One line a picture: scene, camera, method, variant, XXH3 of its bytes. Scenes whose names hold `only`; empty: all.
std::string pictureHashes(const gpu::Device& device, const std::string& only);

} // namespace brume::bench
