// Random numbers that are equal with every compiler and library: counter-based (splitmix64), no hidden state.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace brume {

// Steele, Lea, Flood 2014: every bit of the input changes every bit of the output with probability one half.
constexpr uint64_t mix64(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

// One stream of random numbers per (seed, index). A particle uses its own index, so that its numbers depend on
// nothing else.
class Random {
public:
    explicit constexpr Random(uint64_t seed, uint64_t index = 0) : state_(mix64(mix64(seed + kStep) + index * kStep)) {}

    constexpr uint64_t bits() { return mix64(state_ += kStep); }
    constexpr float uniform() { return static_cast<float>(bits() >> 40) * 0x1p-24f; } // in [0, 1)
    constexpr float uniform(float lo, float hi) { return lo + (hi - lo) * uniform(); }
    glm::vec3 inBox() { // in [-1, 1)^3
        const float x = uniform(-1, 1), y = uniform(-1, 1);
        return {x, y, uniform(-1, 1)};
    }
    glm::vec3 inBall() { // uniform in the unit ball
        for (;;)
            if (const glm::vec3 p = inBox(); glm::dot(p, p) <= 1) return p;
    }
    glm::vec2 inDisc() { // uniform in the unit disc
        for (;;) {
            const float x = uniform(-1, 1), y = uniform(-1, 1);
            if (x * x + y * y <= 1) return {x, y};
        }
    }
    glm::vec3 direction() { // uniform on the unit sphere
        for (;;)
            if (const glm::vec3 p = inBall(); glm::dot(p, p) > 1e-4f) return glm::normalize(p);
    }

private:
    static constexpr uint64_t kStep = 0x9e3779b97f4a7c15u; // 2^64 / golden ratio
    uint64_t state_;
};

} // namespace brume
