// UnionPath: light of the sun behind the union of balls, one value for each particle (Mattsson, Lund 2022), once per
// tick for all viewers. Rays find balls in cells of the plane across them and merge intervals; nothing is sorted, and
// no hit is left out. On a ray with more than kMostParts separate parts the smallest gaps count as covered.
#pragma once

#include <array>
#include <vector>

#include "server/gpu/commands.h"
#include "server/gpu/variants.h"
#include "server/inputs/medium_view.h"
#include "server/sim/simulation.h"
#include "shaders/shared/types.h"

namespace brume {

class UnionPath {
public:
    explicit UnionPath(const gpu::Device& device);

    // Makes room, and chooses the particles whose light is computed. With PathSettings::groups G, particle i has the
    // value of the newest tick t with t % G == i % G. So values depend on the tick alone, not on the pictures that were
    // drawn before. G is 1 where the simulation keeps no past, and with coloured extinction.
    // `tick`: the present one of all particles; `particles`, `objects`: numbers that change whenever one of them does.
    // Precondition: nothing of it is on the device. Throws gpu::Error for more than limits::kUnionCount particles.
    void prepare(const Simulation& simulation, const SceneNow& now, const gpu::Tick& tick, uint64_t particles,
                 uint64_t objects);

    // Records the light of what prepare() chose, with the extinction of the TickBlock of `all`, past boxes, spheres and
    // planes.
    void record(gpu::Commands& commands, const MediumView& all);
    // From now on the buffer's light is not valid.
    void invalidate() { valid_ = false; }
    // Frees its memory. Precondition: nothing of it is on the device.
    void giveBack() {
        invalidate();
        bits_ = {}, lights_ = {}, blocks_ = {}, particles_ = {};
    }

    const gpu::Buffer& bins() const { return bits_; }     // uint[row][column][word]: bits of particles
    const gpu::Buffer& lights() const { return lights_; } // gpu::ParticleLight[]

private:
    struct Update {
        uint64_t tick;
        uint32_t group;
    };
    // What all values depend on, besides the particles.
    struct Key {
        gpu::UnionBalls balls{};
        uint64_t objects = 0;
        uint32_t groups = 0;
        bool operator==(const Key& other) const;
    };
    // `tick`: TickBlock and Particles of the tick that they are of.
    void recordBins(gpu::Commands& commands, const gpu::Resources& tick);
    void recordGroup(gpu::Commands& commands, const gpu::Resources& tick, uint32_t group);

    const gpu::Device& device_;
    gpu::Variants bins_program_, path_program_;
    gpu::Buffer bits_, lights_;
    gpu::Buffer blocks_, particles_; // gpu::Tick of past ticks, and their particles
    Key key_;
    std::array<uint64_t, size_t(limits::kPathGroups.hi)> made_{}; // the tick of each group's values
    bool valid_ = false;                                          // True: `made_` and `key_` are of the buffer's light
    uint64_t of_particles_ = 0;                                   // version of the particles that the cells hold
    glm::vec3 to_light_{0};                                       // across which they are
    uint64_t now_ = 0;
    uint32_t count_ = 0;
    bool bins_ = false;        // True: the cells are to be made
    std::vector<Update> past_; // groups whose light is that of ticks before
    bool present_ = false;     // True: the present tick's group is to be computed
};

} // namespace brume
