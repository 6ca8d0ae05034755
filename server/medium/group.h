// Group: particles that are merged to one.
#pragma once

#include <cmath>

#include "shaders/shared/types.h"

namespace brume {

inline constexpr double kUnitMass = 15.749609945722419;  // (2 pi)^1.5, of a Gaussian of unit peak and deviation
inline constexpr double kUnitDepth = 2.5066282746310002; // sqrt(2 pi), of the line through its centre

// Sums over the particles. Places count from the first: no cancellation far from zero.
struct Group {
    uint32_t members = 0;
    const gpu::Particle* first = nullptr;
    double depth = 0;   // of the lines through the centres, together
    double mass = 0;    // integral of the extinction over space, m^2
    double squares = 0; // mass * (3 s^2 + |x|^2)
    glm::dvec3 places{0};
    glm::dvec3 scattered{0}; // mass * albedo
    bool one_albedo = true;

    // s: the particle's deviation, m; m: its mass; d: depth of its line.
    void add(const gpu::Particle& p, double s, double m, double d) {
        if (members++ == 0) first = &p;
        const glm::dvec3 at = glm::dvec3(p.centre) - glm::dvec3(first->centre);
        depth += d;
        mass += m;
        places += m * at;
        squares += m * (3 * s * s + glm::dot(at, at));
        scattered += m * glm::dvec3(p.albedo);
        one_albedo = one_albedo && p.albedo == first->albedo;
    }
    void add(const gpu::Particle& p, double falloff) {
        const double s = 0.1 * double(p.scale) * falloff;
        add(p, s, kUnitMass * double(p.sigma_t) * s * s * s, kUnitDepth * double(p.sigma_t) * s);
    }

    // Keeps the integral of the extinction over space, the scattered part of it in each colour, the centre of mass and
    // the isotropic second moment. Precondition: there is a member.
    gpu::Particle merged(double falloff) const {
        if (members == 1 || !(mass > 0)) return *first;
        const glm::dvec3 mean = places / mass;
        const double variance = (squares / mass - glm::dot(mean, mean)) / 3;
        gpu::Particle p{};
        p.centre = glm::vec3(glm::dvec3(first->centre) + mean);
        p.scale = float(10 * std::sqrt(variance) / falloff);
        const double s = 0.1 * double(p.scale) * falloff; // as rounded: the mass is kept to the rounding of sigma_t
        p.sigma_t = float(mass / (kUnitMass * s * s * s));
        p.albedo = one_albedo ? first->albedo : glm::vec3(scattered / mass);
        return p;
    }
};

} // namespace brume
