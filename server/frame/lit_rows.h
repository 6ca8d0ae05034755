// The light on particles as the columns of a message (protocol/lit_particles.h).
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

#include "common/lit_medium.h"
#include "protocol/lit_particles.h"
#include "server/render/renderer.h"

namespace brume {

struct LitRows {
    lit::Rows rows;
    glm::vec3 origin{0}; // m
    float step = 1;      // m, of places: at most 1/64 of the smallest particle's deviation, if 65,536 steps reach
};

// What viewers have of these rows. `fits`: that they were made of.
lit::Medium litMedium(const LitRows& made, const Submission::Fits& fits);
// The same before anything was rounded.
lit::Medium litMedium(const Submission::Fits& fits);

// `first`: id of the first particle. Numbers are rounded to the columns' steps.
LitRows litRows(const Submission::Fits& fits, uint64_t first);

} // namespace brume
