// Motion: what moves the particles of a scene, and how long they live. A motion of another kind is another class, made
// in the constructor of Simulation::State.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include <glm/glm.hpp>

#include "common/scene.h"
#include "server/sim/columns.h"
#include "server/sim/particle_rows.h"
#include "server/sim/state_bytes.h"

namespace brume {

struct MotionStep {
    uint64_t number = 0; // of the step, counted from 1: time is number * kTickSeconds
    glm::vec3 volume{0}; // m, offset of the whole medium
    const SimulationSettings& settings;
};

class Motion {
public:
    virtual ~Motion() = default;

    // Steps that run before tick 0, so that the first picture shows the medium as it is later.
    virtual uint64_t runUp() const { return 0; }
    // Moves the living particles by kTickSeconds, retires some and adds others. Allocates nothing.
    virtual void step(Columns& columns, const MotionStep& step) = 0;
    // Sets scale and sigma of the living particles. Called after every step and after every change of the extinction
    // (1/m).
    virtual void settle(Columns& columns, float extinction) = 0;

    // Rows of the living particles in at most two runs, in an order that is part of the state.
    virtual std::array<Rows, 2> living() const = 0;
    uint32_t liveCount() const {
        uint32_t count = 0;
        for (const Rows run : living()) count += run.end - run.begin;
        return count;
    }
    // Single-scattering albedos that came with the particles, one for each row. Empty where all have the medium's.
    virtual std::span<const glm::vec3> albedos() const { return {}; }
    // Place (m) where particles come from while none lives, relative to the volume. Empty where some always live.
    virtual std::optional<glm::vec3> source() const { return {}; }
    // True: row i is the same particle in all ticks, and all rows live.
    virtual bool keepsPlaces() const { return false; }
    // Id of the first living particle. The others' follow by one, and a particle keeps its own.
    virtual uint64_t firstId() const { return 0; }
    // True: impulses move the particles.
    virtual bool yields() const { return true; }
    // For the state's hash: what can differ between two runs besides the columns, like births so far, as one number.
    virtual uint64_t history() const { return 0; }
    virtual uint64_t bytes() const { return 0; } // of memory besides the columns

    // Takes a message about particles at `now`, before the step of that number. Nothing where the layout is not `live`.
    virtual void set(Columns& /*columns*/, const SetParticles& /*particles*/, const MotionStep& /*now*/) {}

    // Writes or reads what this object knows besides the columns and the scene. `now`: the last step that was taken.
    // Columns of the living rows follow it, so it may leave them in any state.
    virtual void exchange(StateBytes& /*bytes*/, Columns& /*columns*/, const MotionStep& /*now*/) {}

    // keepStart() remembers what this object knows besides the columns; restart() goes back to it.
    virtual void keepStart() {}
    virtual void restart() {}
};

} // namespace brume
