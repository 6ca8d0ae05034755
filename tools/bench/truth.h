// Truth: reference pictures in double precision, cached on disk.
#pragma once

#include <filesystem>

#include "tools/bench/stage.h"
#include "tools/reference/tracker.h"
#include "tools/reference/world.h"

namespace brume::bench {

class Truth {
public:
    // Makes `folder` if it is missing.
    explicit Truth(std::filesystem::path folder);

    // The reference picture of the stage's present scene from `pose`: overlapping, uncut Gaussians in double precision.
    // A pixel is the ray through its centre. Where an edge of an object or of its shadow crosses it, it is the mean of
    // 2x2 rays, which smooths the edge, and RadianceImage::edges is 1. `every`: only every so many-th pixel, odd,
    // divides the size; see thinned().
    RadianceImage of(const Stage& stage, const Pose& pose, glm::uvec2 size, uint32_t every = 1);

    // The same with light that scatters any number of times, by so many random paths through each pixel's centre. Not
    // kept on disk. `error`: the root of the mean squared standard error over that of the mean squared radiance.
    RadianceImage scattered(const Stage& stage, const Pose& pose, glm::uvec2 size, int paths, double& error);

private:
    std::filesystem::path folder_;
};

// The stage's present scene by so many random paths through each pixel's centre.
reference::TrackedPicture tracked(const Stage& stage, const Pose& pose, glm::uvec2 size, int paths);

// Some pixels of such a picture, as a picture of one row. It ends with the last that is begun within `seconds`, but not
// before `least`.
RadianceImage truthAt(const Stage& stage, const Pose& pose, glm::uvec2 size, std::span<const glm::uvec2> pixels,
                      double seconds, size_t least);

// Name of the cached file: a hash of everything that the picture depends on.
std::string truthFile(const reference::World& world, const Pose& pose, glm::uvec2 size, uint32_t every);

// The middle pixel of every block of every x every pixels. Throws std::runtime_error unless `every` is odd and
// divides the size.
glm::uvec2 thinned(glm::uvec2 size, uint32_t every);
RadianceImage thinned(const RadianceImage& image, uint32_t every);

} // namespace brume::bench
