// The loops over all particles. Each is a plain formula per particle; the compiler vectorises them, with the same bits for any
// width.
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
    glm::vec3 volume{0}; // m, added to every home
};
void springStep(Columns& columns, Rows rows, const SpringStep& step);

// dv/dt = viscosity (air - v) + buoyancy (1 - age / life) in +Y, air = wind + turbulence; and everything gets older.
struct PlumeStep {
    float dt = 0;        // s
    float viscosity = 0; // 1/s
    glm::vec3 wind{0};   // m/s
    float buoyancy = 0;  // m/s^2
    float life = 1;      // s
};
void plumeStep(Columns& columns, Rows rows, const PlumeStep& step, const Turbulence::Modes& turbulence);

// Scale and sigma at a particle's age. It grows, and thins so that its optical mass sigma_t * scale^3 stays, except while it
// appears (a tenth of its life, at most kAppear) and while it dissolves (the last kDissolve of its life).
struct Ageing {
    static constexpr float kAppear = 0.5f;    // s: hides the disc that births fall on
    static constexpr float kDissolve = 0.35f; // of the life: smoke thins out rather than vanishing
    float life = 1;                           // s
    float growth = 0;                         // m/s
    float extinction = 0;                     // times a particle's weight: sigma_t at birth
};
void age(Columns& columns, Rows rows, const Ageing& ageing);

// v += (1 - d^2 / radius^2)^2 (along + away * radial), d = distance to the ray, in front of its origin only; speeds stay within
// the scene's limits.
struct Push {
    glm::vec3 origin{0}, direction{0, 0, -1}; // m, unit
    float radius = 1;                         // m
    glm::vec3 along{0};                       // m/s on the ray
    float away = 0;                           // m/s, out from the ray; falls to zero on it, where there is no outward direction
};
void push(Columns& columns, Rows rows, const Push& push);

// sigma = weight * extinction
void setSigma(Columns& columns, Rows rows, float extinction);

// Widens `bounds` to hold the rows.
void widen(Bounds& bounds, const Columns& columns, Rows rows);

} // namespace brume
