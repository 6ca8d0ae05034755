// Truth: reference pictures in double precision, cached on disk.
#pragma once

#include <filesystem>

#include "tools/bench/stage.h"
#include "tools/reference/world.h"

namespace brume::bench {

class Truth {
public:
    // Makes `folder` if it is missing.
    explicit Truth(std::filesystem::path folder);

    // The reference picture of the stage's present scene from `pose`: overlapping, uncut Gaussians in double
    // precision. A pixel is the ray through its centre; in scenes with opaque objects it is the mean of 2x2 rays,
    // which smooths edges. `every`: only every so many-th pixel, odd, divides the size; see thinned(). `centres`:
    // true for one ray per pixel also with objects, as the renderer draws it. Then all error that is left is the
    // medium's.
    RadianceImage of(const Stage& stage, const Pose& pose, glm::uvec2 size, uint32_t every = 1, bool centres = false);

private:
    std::filesystem::path folder_;
};

// Name of the cached file: a hash of everything that the picture depends on.
std::string truthFile(const reference::World& world, const Pose& pose, glm::uvec2 size, uint32_t every, bool centres);

// The middle pixel of every block of every x every pixels. Throws std::runtime_error unless `every` is odd and
// divides the size.
glm::uvec2 thinned(glm::uvec2 size, uint32_t every);
RadianceImage thinned(const RadianceImage& image, uint32_t every);

} // namespace brume::bench
