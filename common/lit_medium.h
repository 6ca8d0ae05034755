// LitMedium: what a viewer who draws by himself has, and what he sees of it, in double. His graphics processor does the
// same at coarse rays between which it interpolates (client/web/src/lit-medium.ts).
#pragma once

#include <array>
#include <vector>

#include <glm/glm.hpp>

#include "protocol/lit_particles.h"
#include "shaders/shared/lit_particles.h"

namespace brume::lit {

inline constexpr uint32_t kSlabs = 8; // of a ray

struct Medium {
    struct Particle {
        glm::dvec3 centre{0};    // m
        double scale = 1, k = 1; // m, 1/m: the extinction is sigma_t exp(-k^2 |x - centre|^2)
        double sigma_t = 0;      // 1/m
        glm::dvec3 albedo{0};
        std::array<physics::LitFit<double>, kHues> fits{}; // of each hue
        std::array<glm::dvec4, kHues> fluence{};           // of each channel: net flux, fluence, for an irradiance of 1
    };
    struct Hue {
        uint32_t channels = 7; // bits of red, green and blue
        double extinction = 1; // part of the particles' extinction
    };
    std::vector<Particle> particles;
    std::vector<Hue> hues{Hue{}};
    glm::dvec3 to_light{0, 1, 0}, irradiance{0}, ambient{0};
    glm::dvec3 emission{0}, cold_albedo{1}; // physics::emitted()
    glm::dvec4 phase{0};                    // numbers of phaseOfLobes()
    bool scatters_on = false;               // True: there is light that scattered more than once
    glm::dvec3 straight{1};                 // part of the extinction that dims light which scatters straight on, too
    double mean_cosine = 0;
};

// Places are origin + step * number. Adds the rows' particles; the rest of the medium stays.
void addParticles(const Rows& rows, glm::dvec3 origin, double step, double falloff, Medium& medium);

struct Seen {
    glm::dvec3 radiance{0}, transmittance{1};
};
// The medium on a ray from `near` to `far`, m from its origin; `direction` is unit. `slabs`: more than kSlabs tell what
// the slabs' number errs.
Seen along(const Medium& medium, glm::dvec3 origin, glm::dvec3 direction, double near, double far,
           uint32_t slabs = kSlabs);

} // namespace brume::lit
