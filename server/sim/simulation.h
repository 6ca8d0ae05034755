// The shared simulation: deterministic, fixed step, on the CPU. Seed 000 section 3.14, plus an emitter.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/scene.h"
#include "common/settings.h"
#include "server/sim/command.h"
#include "server/sim/lists.h"
#include "server/sim/past.h"
#include "server/sim/state_bytes.h"
#include "shaders/shared/types.h"

namespace brume {

inline constexpr double kTickSeconds = 1.0 / 60.0;

struct Bounds {
    glm::vec3 lo{0}, hi{0}; // of the particles' centres, m
    float max_scale = 0;    // the largest particle's scale, m
    float max_sigma_t = 0;  // the largest peak extinction, 1/m
};

// The parts of the scene that commands and time can change, at their present values.
struct SceneNow {
    Medium medium;
    Light light; // the directional one
    SceneLists lists;
    RenderSettings render;
    SimulationSettings simulation;
};
// Where its settings lie that are in no list.
inline SceneParts partsOf(SceneNow& now) {
    return {.medium = &now.medium, .simulation = &now.simulation, .light = &now.light, .render = &now.render};
}

// A command that asked for what cannot be: it changed nothing.
struct RefusedCommand {
    uint32_t viewer = 0, seq = 0; // Command's
    std::string why;              // one line
};

struct PointCloudFacts; // server/sim/layout.h

class Simulation {
public:
    // `most_bytes`: of points that a sequence holds. Throws SceneError when one of the scene's particle files is bad,
    // and for more bytes.
    explicit Simulation(const Scene& scene, uint64_t most_bytes = ~0ull);
    ~Simulation();
    Simulation(Simulation&&) noexcept;
    Simulation& operator=(Simulation&&) noexcept;

    // The state before the first step is of this tick, not of tick 0. Precondition: nothing was stepped.
    void countFrom(uint64_t tick);

    // The whole state as bytes, of which one of the same scene and version makes it again. Of a union medium they leave
    // out past(). `out` is cleared first.
    void save(std::vector<std::byte>& out) const;
    // Goes on from such bytes. Throws StateError for those of another scene, cut or changed ones; then nothing but
    // destroying is allowed. Precondition: made of the same scene.
    void load(std::span<const std::byte> bytes);

    // One tick of 1/60 s: applies the commands in order, then moves the particles unless paused. Allocates nothing but
    // for commands that change lists or settings: how these were before is kept for Undo.
    void step(std::span<const Command> commands);
    // Of the last step.
    std::span<const RefusedCommand> refused() const;

    uint64_t tick() const;
    // 64-bit hash of the whole state after the last step; equal seeds and commands give equal hashes.
    uint64_t stateHash() const;
    // Of the seed and all particles at the start: another one is another scene.
    uint64_t origin() const;
    // Of the lists after the last command that changed them: all live settings of their elements.
    uint64_t listsHash() const;
    // A number that grows when a command sets settings. What changes by itself (a turning light) leaves it as it is.
    uint64_t settingsVersion() const;
    // What Undo would do now, in a few words for people; empty: there is nothing to undo.
    std::string undoText() const;
    uint32_t liveCount() const;
    uint64_t firstId() const;  // Motion::firstId(), of the particles as write() has them
    uint32_t capacity() const; // most particles that can be alive at once
    uint64_t bytes() const;    // of the particles' memory in the simulation
    uint64_t besides() const;  // that part of it which all particles' own columns do not make up
    const Bounds& bounds() const;
    const SceneNow& now() const;
    const PointCloudFacts* pointCloud() const; // null unless points come from files
    // The last limits::kPathGroups.hi ticks, of a union medium whose particles stay the same ones. Null: of others.
    const Past* past() const;
    // The particles' semi-axes in the order of write(), which never change; empty unless they are ellipsoids.
    std::span<const gpu::EllipsoidAxes> axes() const;
    // Writes every so many of the live particles, in a stable order, beginning with the first. Precondition: `out` has
    // room for liveCount() / every of them, rounded up.
    void write(std::span<gpu::Particle> out, uint32_t every = 1) const;

private:
    void keepPast();

    struct State;
    std::unique_ptr<State> state_;
};

} // namespace brume
