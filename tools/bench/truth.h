// Reference pictures, kept on disk: what a scene truly looks like.
#pragma once

#include <filesystem>

#include "tools/bench/stage.h"
#include "tools/reference/world.h"

namespace brume::bench {

class Truth {
public:
    // `folder` is made when it is missing.
    explicit Truth(std::filesystem::path folder);

    // The true overlapping medium of whole Gaussians, in double precision, as `pose` sees the stage's scene now. Where there are
    // opaque objects a pixel is the mean of 2x2 rays, since their edges are no points; else its centre's. `every`: only every so
    // many-th pixel of the size, an odd number that divides it; see thinned(). `centres`: a pixel is its centre's ray in any
    // case, as the renderer draws it, so that what is left of an error is the medium's.
    RadianceImage of(const Stage& stage, const Pose& pose, glm::uvec2 size, uint32_t every = 1, bool centres = false);

private:
    std::filesystem::path folder_;
};

// The file's name: a hash of everything that the picture depends on.
std::string truthFile(const reference::World& world, const Pose& pose, glm::uvec2 size, uint32_t every, bool centres);

// The middle one of every so many pixels by as many. Throws std::runtime_error unless `every` is odd and divides the size.
glm::uvec2 thinned(glm::uvec2 size, uint32_t every);
RadianceImage thinned(const RadianceImage& image, uint32_t every);

} // namespace brume::bench
