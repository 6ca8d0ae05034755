// Closed forms of light that the medium throws on surfaces: shaders/shared/glow.h.
#include <cmath>

#include <gtest/gtest.h>

#include "shaders/shared/glow.h"

namespace brume::physics {
namespace {

// Of light from one direction a surface gets the cosine's part, or none from behind. Of even light it gets a quarter of
// the fluence, whatever its normal.
TEST(Glow, IrradianceIsExactForOneDirectionAndForEvenLight) {
    const glm::dvec3 travel = glm::normalize(glm::dvec3(0.3, -0.8, 0.5));
    for (const glm::dvec3 way : {glm::dvec3(0, 1, 0), glm::dvec3(-0.3, 0.5, 2), glm::dvec3(0.9, -0.2, 1e-3)}) {
        const glm::dvec3 n = glm::normalize(way);
        EXPECT_NEAR(irradianceOf(7.0, 7.0 * travel, n), std::max(-7 * glm::dot(travel, n), 0.0), 1e-12);
        EXPECT_NEAR(irradianceOf(7.0, glm::dvec3(0), n), 7.0 / 4, 1e-12);
    }
    // A hemisphere of even light: fluence 2 pi, net flux pi.
    const double pi = std::acos(-1.0);
    EXPECT_NEAR(irradianceOf(2 * pi, glm::dvec3(0, -pi, 0), glm::dvec3(0, 1, 0)), 1.25 * pi, 1e-12) << "pi is right";
}

} // namespace
} // namespace brume::physics
