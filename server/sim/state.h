// Simulation::State: all that a simulation is. Only what makes up the simulation includes it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "server/sim/columns.h"
#include "server/sim/layout.h"
#include "server/sim/motion.h"
#include "server/sim/obstacles.h"
#include "server/sim/simulation.h"
#include "server/sim/undo.h"

namespace brume {

// All live settings of one type, in the order of the table.
template <class T, class F>
void eachLive(const SceneParts& parts, F&& f) {
    for (const SceneSetting* setting : liveSettings()) {
        const Member member = setting->member(parts);
        if (T* const* value = std::get_if<T*>(&member)) f(**value);
    }
}

struct Simulation::State {
    State(const Scene& scene, uint64_t most_bytes);

    // Each returns why the command is refused, in one line; empty: it is not.
    std::string apply(const Impulse& c);
    std::string apply(const MoveVolume& c);
    std::string apply(const Set& c);
    std::string apply(const Restart&);
    std::string apply(const SetParticles& c);
    std::string apply(const Add& c);
    std::string apply(const Remove& c);
    std::string apply(const Undo& c);
    std::string give(const Set& c); // apply(), without keeping how it was before
    template <class Edit>
    std::string change(Edit edit);
    Before before(const Set& c);
    void keep(Before change); // to be called after the change

    void advance(); // one step of the particles, the volume and the light
    void settle();  // what follows from the rest: sigma, bounds, hash
    glm::vec3 volume() const;
    uint64_t hashed();
    void exchange(StateBytes& bytes);
    void exchangeColumns(StateBytes& bytes);

    const bool sky_lights; // Sky::lights
    uint32_t rows = 0;
    std::optional<PointCloudFacts> cloud;
    std::vector<gpu::EllipsoidAxes> axes; // Simulation::axes()
    std::optional<Columns> columns;
    std::unique_ptr<Motion> motion;
    std::optional<Obstacles> obstacles; // nothing: particles pass through all that is there
    uint64_t settings_version = 0;
    uint64_t steps = 0, first_step = 0; // simulated so far; and when tick 0 was, after the motion's run-up
    glm::vec3 moved{0};                 // m, the volume, by commands
    SceneNow now;

    std::optional<Columns> first_columns; // as after loading, for Restart
    SceneNow first_now;

    SceneLists tried; // those that a command would make
    uint64_t lists_hash = 0;
    ChangeStack changes;                 // that can be taken back
    bool lists_changed = false;          // True: lists_hash is of those before
    std::vector<RefusedCommand> refused; // in this tick

    uint64_t tick = 0, hash = 0, origin = 0; // origin: a hash of the seed and all columns at the start
    uint32_t impulses = 0;                   // in this tick
    Bounds bounds;
    std::optional<Past> past;
};

// Changes the lists as `edit` does, or says why that cannot be: then they stay.
template <class Edit>
std::string Simulation::State::change(Edit edit) {
    tried = now.lists;
    std::string problem = edit(tried);
    if (problem.empty()) problem = problemOf(tried, now.medium.layout != Layout::none);
    if (problem.empty() && !isMixable(now.medium) && !(tried.fogs.empty() && tried.lights.empty()))
        problem = "fog, points and spots are drawn only with medium.model = \"sum\"";
    if (!problem.empty()) return problem;
    std::swap(now.lists, tried);
    lists_changed = true;
    ++settings_version;
    return {};
}

} // namespace brume
