// Loops over all particles. Each applies one formula per particle. The compiler vectorises them; the result has the
// same bits for any vector width.
#pragma once

#include <span>

#include <glm/glm.hpp>

#include "server/sim/columns.h"
#include "server/sim/simulation.h"
#include "server/sim/turbulence.h"

namespace brume {

// v' = (v + dt spring (target - x)) / (1 + dt viscosity), x' = x + dt v': semi-implicit, so that it never gains energy.
struct SpringStep {
    float dt = 0;        // s
    float spring = 0;    // 1/s^2
    float viscosity = 0; // 1/s
    glm::vec3 volume{0}; // m, offset of all targets
};
void springStep(Columns& columns, Rows rows, const SpringStep& step);

// dv/dt = viscosity (air - v) + buoyancy (1 - age / life) in +Y, air = wind + turbulence. Ages grow by dt.
struct PlumeStep {
    float dt = 0;        // s
    float viscosity = 0; // 1/s
    glm::vec3 wind{0};   // m/s
    float buoyancy = 0;  // m/s^2
    float life = 1;      // s
};
void plumeStep(Columns& columns, Rows rows, const PlumeStep& step, const Turbulence::Modes& turbulence);

// Sets scale and sigma from a particle's age. The scale grows, and sigma_t falls so that the optical mass sigma_t *
// scale^3 stays constant. Exceptions: it fades in during a tenth of its life, at most kAppear, and fades out in the
// last kDissolve of its life.
struct Ageing {
    static constexpr float kAppear = 0.5f;    // s: a slow start hides the disc on which particles are born
    static constexpr float kDissolve = 0.35f; // part of the life: smoke thins out instead of vanishing
    float life = 1;                           // s
    float growth = 0;                         // m/s
    float extinction = 0;                     // 1/m: times a particle's weight, its sigma_t at birth
};
void age(Columns& columns, Rows rows, const Ageing& ageing);

// v += (1 - d^2 / radius^2)^2 (along + away * radial), d = distance to the ray, only in front of its origin. Speeds
// stay within the scene's limits.
struct Push {
    glm::vec3 origin{0}, direction{0, 0, -1}; // m, unit
    float radius = 1;                         // m
    glm::vec3 along{0};                       // m/s on the ray
    float away = 0;                           // m/s, away from the ray; zero on the ray, which has no outward direction
};
void push(Columns& columns, Rows rows, const Push& push);

// sigma = weight * extinction
void setSigma(Columns& columns, Rows rows, float extinction);
// The same where weights are extinctions of the particles' own: sigma = min(weight * factor, limits::kSigmaT.hi)
void scaleSigma(Columns& columns, Rows rows, float factor);

// Widens `bounds` to hold the rows.
void widen(Bounds& bounds, const Columns& columns, Rows rows);

} // namespace brume
