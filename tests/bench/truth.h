// Reference pictures, kept on disk: what a scene truly looks like.
#pragma once

#include <filesystem>

#include "tests/bench/stage.h"

namespace brume::bench {

class Truth {
public:
    // `folder` is made when it is missing.
    explicit Truth(std::filesystem::path folder);

    // The true overlapping medium of whole Gaussians, in double precision, as `pose` sees the stage's scene now. Where there are
    // opaque objects a pixel is the mean of 2x2 rays, since their edges are no points; else its centre's.
    RadianceImage of(const Stage& stage, const Pose& pose, glm::uvec2 size);

private:
    std::filesystem::path folder_;
};

} // namespace brume::bench
