#include "tools/random_scene/random_layout.h"

#include <algorithm>
#include <cmath>

namespace brume {
namespace {

enum Kind : uint32_t { ball, cluster, sheet, filament, shell, plume, cloud_in_cloud };
constexpr const char* kNames[] = {"ball", "cluster", "sheet", "filament", "shell", "plume", "cloud in a cloud"};

// The base-2 logarithm, interpolated linearly between powers of two, and its inverse: no function whose last bit
// depends on the machine.
float exponentOf(float value) {
    int exponent = 0;
    const float mantissa = std::frexp(value, &exponent); // in [0.5, 1)
    return float(exponent - 1) + (2 * mantissa - 1);
}
float fromExponent(float exponent) {
    const float whole = std::floor(exponent);
    return std::ldexp(1 + (exponent - whole), int(whole));
}

// The smallest whole number whose power of `dimensions` is at least `count`.
uint32_t sideOf(uint32_t count, uint32_t dimensions) {
    const auto power = [&](uint64_t side) {
        uint64_t product = 1;
        for (uint32_t i = 0; i < dimensions; ++i) product *= side;
        return product;
    };
    uint32_t side = 1;
    while (power(side) < count) ++side;
    return side;
}

// About normal, at most 2 from the origin along each axis.
glm::vec3 bump(Random& random) {
    glm::vec3 sum(0);
    for (int i = 0; i < 4; ++i) sum += random.inBox();
    return 0.5f * sum;
}

struct Axes {
    glm::vec3 x, y, z;
};
Axes randomAxes(Random& random) {
    const glm::vec3 z = random.direction();
    const glm::vec3 x = glm::normalize(glm::cross(z, std::abs(z.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0)));
    return {x, glm::cross(z, x), z};
}

} // namespace

float logUniform(Random& random, float lo, float hi) {
    const float from = exponentOf(lo), to = exponentOf(hi);
    return std::clamp(fromExponent(random.uniform(from, to)), lo, hi);
}

std::span<const char* const> randomLayouts() { return kNames; }

RandomPoints randomPoints(uint32_t layout, uint32_t count, float spread, Random& random) {
    constexpr uint32_t kDimensions[] = {3, 3, 2, 1, 2, 3, 3};
    // From separate particles to a smooth body.
    const float overlap = logUniform(random, 0.25f, 4);
    const float deviation =
        std::clamp(overlap / float(sideOf(count, kDimensions[layout])), 0.004f, 0.6f); // of the largest
    const Axes axes = randomAxes(random);
    const float thickness = logUniform(random, 0.01f, 0.1f);
    const glm::vec3 bend = random.inBall();
    std::vector<glm::vec3> centres(2 + random.bits() % 7);
    for (glm::vec3& centre : centres) centre = 0.8f * random.inBall();

    RandomPoints out;
    for (uint32_t i = 0; i < count; ++i) {
        glm::vec3 at = random.inBall();
        float factor = 1;
        if (layout == cluster) {
            at = 0.2f * bump(random);
            at += centres[random.bits() % centres.size()];
        }
        if (layout == shell) {
            const float radius = random.uniform(1 - thickness, 1);
            at = radius * random.direction();
        }
        if (layout == sheet) {
            const glm::vec2 disc = random.inDisc();
            at = disc.x * axes.x + disc.y * axes.y + thickness * random.uniform(-1, 1) * axes.z;
        }
        if (layout == filament) {
            const float t = random.uniform(-1, 1);
            at = t * axes.z + (1 - t * t) * bend + thickness * bump(random);
        }
        if (layout == plume) {
            const float height = random.uniform();
            const glm::vec2 disc = (0.1f + 0.4f * height) * random.inDisc();
            at = {disc.x + 0.3f * height * bend.x, 2 * height - 1, disc.y + 0.3f * height * bend.z};
            factor = 0.3f + 0.7f * height;
        }
        if (layout == cloud_in_cloud && i % 2 == 0) at = 0.3f * (at + bend), factor = 0.3f;
        out.position.push_back(at);
        out.deviation.push_back(factor * deviation / logUniform(random, 1, spread));
    }
    return out;
}

} // namespace brume
