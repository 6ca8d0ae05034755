// The particles of a tick on their way to the device: in the order of space where they are many, and as levels of
// detail for eyes far away. Nothing is uploaded that the device has already.
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "server/inputs/eye_request.h"
#include "server/inputs/hues.h"
#include "server/inputs/medium_view.h"
#include "server/render/merged_media.h"
#include "server/render/uniform_blocks.h"
#include "server/sim/simulation.h"

namespace brume {

class TickUpload {
public:
    // For at most `capacity` particles.
    TickUpload(const gpu::Device& device, uint32_t capacity);

    // Takes the simulation's particles for these eyes, and writes to `staging` what is new. `scene`, `now`, `objects`:
    // as makeTick() wants them. Precondition: nothing of this is on the device.
    void take(const Simulation& simulation, const Scene& scene, const SceneNow& now,
              std::span<const gpu::Opaque> objects, std::span<const EyeRequest> eyes, gpu::Buffer& staging);
    // Writes the tick's blocks in all hues, and makes views of all lists, with those of the first hue. After take().
    // Their resources lie within `shared`.
    void writeBlocks(const UniformBlocks& blocks, std::span<const Hue> hues, const gpu::Resources& shared);
    // From now on the views have the blocks of this hue.
    void enter(const UniformBlocks& blocks, uint32_t hue);
    // Records the copies from `staging`. Ends with its writes visible to compute.
    void record(gpu::Commands& commands, const gpu::Buffer& staging) const;
    // The submission is on its way: what take() found is what the device has.
    void submitted() { std::swap(now_, then_), axes_there_ |= axes_wait_; }
    // The device has nothing: the next take() uploads everything.
    void forget() { then_.clear(), forgotten_ = true, axes_there_ = false; }

    uint32_t capacity() const { return capacity_; }
    const gpu::Tick& tick() const { return tick_; }
    const MediumExtent& extent() const { return extent_; }
    bool moved() const { return moved_; } // True: the particles are not those of the last submission
    const gpu::Buffer& particles() const { return particles_; }
    // What take() took, in the simulation's order; valid until submitted().
    std::span<const gpu::Particle> list() const { return now_; }

    // All particles, and what eye number `eye` sees.
    MediumView& all() { return all_; }
    const MediumView& of(size_t eye) const;
    // The lists that some eye sees, each once: all particles first, where one sees them. Valid until the next call.
    std::span<MediumView* const> seenBy(size_t eyes);

    uint64_t cpuBytes() const; // that lists of particles take of the CPU's memory

private:
    const gpu::Device& device_;
    const uint32_t capacity_;
    gpu::Buffer particles_;
    gpu::Tick tick_{};
    MediumExtent extent_;
    MediumView all_;
    uint64_t version_ = 0; // of the particles
    MergedMedia levels_;
    std::vector<MediumView*> seen_; // seenBy()
    SpatialOrder order_;
    gpu::Buffer axes_;                                // of ellipsoids, which never change
    std::vector<gpu::Particle> balls_;                // ballsOf() them
    std::vector<gpu::Particle> now_, then_, ordered_; // of this submission, of the last one; now_ in the order of space
    bool forgotten_ = false;                          // True: forget() was called since the last take()
    bool moved_ = true;
    bool axes_wait_ = false;  // True: take() put the axes into `staging`, behind all particles
    bool axes_there_ = false; // True: the device has them
};

} // namespace brume
