// A sample of the medium's particles for laws of errors: a few that stand for all, and those that a view is filled by.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "shaders/shared/types.h"

namespace brume {

struct PlanScene;

// A particle of the sample, as all views see it. It stands for `weight` particles, evenly spread around it.
struct SampledParticle {
    glm::dvec3 centre{0};  // m
    double deviation = 0;  // m
    double depth = 0;      // optical depth of the line through its centre, alone
    double extinction = 0; // 1/m, of the whole medium at its centre
    double to_light = 0;   // optical depth of the whole medium between its centre and the light
    // What the volumetric shadow map's texels err there, squared, over the mean that ShadowedMedium estimates: more
    // where particles crowd.
    double crowding = 1;
    double weight = 1;  // particles that it stands for
    double widened = 0; // m, deviation in sums over the sample: that of what it stands for, with the same extinction
};

// Optical depth of one particle between two points, `length` (m) apart along `direction` from `from`; without `own`
// part of what it stands for, itself.
double depthBetween(const SampledParticle& p, glm::dvec3 from, glm::dvec3 direction, double length, bool own);

class MediumSample {
public:
    MediumSample() = default;
    MediumSample(const PlanScene& scene, std::span<const gpu::Particle> particles);

    // At most 80 particles, evenly chosen. What is around them is summed over up to 512: some milliseconds.
    std::span<const SampledParticle> even() const { return even_; }

    // At most 80 of those in a picture, evenly chosen, and up to 24 that stand for themselves: the ones of up to 32,768
    // whose light fills most of it. pixels(centre, deviation): how many of the picture's a particle covers.
    using Pixels = std::function<double(glm::dvec3 centre, double deviation)>;
    std::vector<SampledParticle> seenIn(const Pixels& pixels) const;

private:
    // Errors of the volumetric shadow map's texels for a spacing of 1 m, squared: an interpolated Gaussian errs by
    // a / s^2 times the square of a spacing (a: optical depth, s: deviation).
    struct TexelErrors {
        glm::dvec3 x{0}, y{0}, to_light{0};
        double uniform = 0; // as if the medium filled a box

        TexelErrors() = default;
        TexelErrors(const PlanScene& scene, std::span<const SampledParticle> all);
        double by(const SampledParticle& p, glm::dvec3 from, double count) const; // at `from`, by what `p` stands for
    };
    void lookAround(SampledParticle& at) const;

    std::vector<SampledParticle> even_, around_, candidates_; // candidates_: centre, deviation, depth and weight
    TexelErrors texels_;
};

} // namespace brume
