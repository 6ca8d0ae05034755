// Measures what the error of method `sprites` is made of: it draws the true union with one of the method's
// simplifications at a time, and with one after another of them up to all.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/bench/sprite_parts.h"
#include "tools/bench/stage.h"

namespace brume::bench {

struct SpriteStep {
    const char* name;
    SpriteWay alone;   // the truth with this simplification only
    SpriteWay chain;   // with it and all steps before
    SpriteWay all_but; // with all but it
};
// From the truth to the method.
std::span<const SpriteStep> spriteSteps();

// Errors are fields: one value for each pixel whose transmittance in the truth is below 0.999. All numbers are over the
// root of the truth's mean square there.
struct PartsOfError {
    struct Part {
        std::string name;
        double alone;   // RMS: the truth with this part only, beside the truth
        double step;    // RMS: the chain's picture beside the one before
        double all_but; // RMS: the method without this part, beside the truth
        double bias;    // mean of the step
    };
    std::vector<Part> parts;
    std::vector<std::vector<double>> products; // mean products of steps: the sum of all is whole^2
    double whole = 0;                          // RMS of the method's error, which the steps add up to
    double closure = 0;                        // RMS of what their sum lacks
    double drawn = 0;                          // RMS: the device's picture beside the method's in double precision
    double outside = 0; // RMS that the method adds where the truth shows no medium, as if in the medium's pixels
    size_t pixels = 0;
};

// `picture`: the device's, of `size`, radiance and transmittance. `light`: what a medium of light 1 has, albedo *
// irradiance * phase function, red.
struct PartsCase {
    glm::uvec2 size;
    uint32_t every;
    const RadianceImage& picture;
    double light;
};
PartsOfError partsOfError(const SpriteParts& sprites, const PartsCase& of);

// One row a case. Throws SceneError unless it is of method sprites, before black, without objects and lobe.
nlohmann::json partsRows(const gpu::Device& device, const std::vector<NamedCase>& cases, glm::uvec2 size,
                         uint32_t every, uint32_t ticks);
// Tables of such rows.
std::string partsTables(const nlohmann::json& series);

} // namespace brume::bench
