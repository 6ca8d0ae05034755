// A divergence-free velocity field: a few random Fourier modes. The velocity of each is perpendicular to its wave
// vector.
#pragma once

#include <array>
#include <cstdint>

#include <glm/glm.hpp>

namespace brume {

// velocity = amplitude * sin(2 pi (wave . x + phase)); amplitude . wave = 0, so the divergence is zero for any
// periodic function.
struct Mode {
    glm::vec3 wave{0};      // turns per metre
    float phase = 0;        // turns, now
    glm::vec3 amplitude{0}; // m/s
};

class Turbulence {
public:
    static constexpr size_t kOctaves = 3, kModesPerOctave = 4, kModes = kOctaves * kModesPerOctave;
    using Modes = std::array<Mode, kModes>;

    // `rms`: m/s of the velocity's length; `eddy`: m, wavelength of the first octave; `wind`: m/s, carries the
    // pattern along.
    Turbulence(uint64_t seed, float rms, float eddy, glm::vec3 wind);

    Modes at(double seconds) const;

private:
    Modes modes_;                            // at time 0
    std::array<double, kModes> frequency_{}; // turns per second
};

// The velocity (m/s) at a place (m). plumeStep() computes the same for many places at once.
glm::vec3 velocityAt(const Turbulence::Modes& modes, glm::vec3 place);

} // namespace brume
