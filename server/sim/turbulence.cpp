#include "server/sim/turbulence.h"

#include <cmath>

#include "common/random.h"
#include "server/sim/sine.h"

namespace brume {

namespace {

// Kolmogorov: velocity goes with wavelength^(1/3), the turn-over rate with wavelength^(-2/3). Octave by octave,
// relative to the first.
constexpr std::array<float, Turbulence::kOctaves> kSpeed{1.0f, 0.793701f, 0.629961f};
constexpr std::array<float, Turbulence::kOctaves> kRate{1.0f, 1.587401f, 2.519842f};

} // namespace

Turbulence::Turbulence(uint64_t seed, float rms, float eddy, glm::vec3 wind) {
    Random random(seed, 0x7475726275); // a stream of its own
    float sum = 0;                     // of squared amplitudes
    for (size_t m = 0; m < kModes; ++m) {
        const size_t octave = m / kModesPerOctave;
        Mode& mode = modes_[m];
        const float wavelength = eddy / static_cast<float>(1u << octave) * random.uniform(0.8f, 1.25f);
        mode.wave = random.direction() / wavelength;
        mode.phase = random.uniform();
        glm::vec3 across{0};
        while (glm::dot(across, across) < 0.01f) {
            const glm::vec3 any = random.direction();
            across = any - mode.wave * (glm::dot(any, mode.wave) / glm::dot(mode.wave, mode.wave));
        }
        mode.amplitude = glm::normalize(across) * kSpeed[octave];
        sum += kSpeed[octave] * kSpeed[octave];
        frequency_[m] = static_cast<double>(rms / eddy * kRate[octave] * random.uniform(0.5f, 1.5f)) -
                        static_cast<double>(glm::dot(mode.wave, wind));
    }
    // A sine's mean square is one half.
    for (Mode& mode : modes_) mode.amplitude *= rms / std::sqrt(sum / 2);
}

Turbulence::Modes Turbulence::at(double seconds) const {
    Modes now = modes_;
    for (size_t m = 0; m < kModes; ++m) {
        const double turns = static_cast<double>(modes_[m].phase) + frequency_[m] * seconds;
        now[m].phase = static_cast<float>(turns - std::floor(turns));
    }
    return now;
}

glm::vec3 velocityAt(const Turbulence::Modes& modes, glm::vec3 place) {
    glm::vec3 velocity{0};
    for (const Mode& mode : modes) velocity += mode.amplitude * sineOfTurns(glm::dot(mode.wave, place) + mode.phase);
    return velocity;
}

} // namespace brume
