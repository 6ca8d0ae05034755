// Layouts of random scenes: where their points are, and how large.
#pragma once

#include <span>
#include <vector>

#include "common/random.h"

namespace brume {

// About log-uniform in [lo, hi]: evenly in the exponent and, between powers of two, in the number. Its ends are exact.
float logUniform(Random& random, float lo, float hi);

std::span<const char* const> randomLayouts();

struct RandomPoints {
    std::vector<glm::vec3> position; // within about one unit of the origin
    std::vector<float> deviation;    // of the same unit
};
// `layout`: a number below randomLayouts().size(). `spread`: largest over smallest deviation.
RandomPoints randomPoints(uint32_t layout, uint32_t count, float spread, Random& random);

} // namespace brume
