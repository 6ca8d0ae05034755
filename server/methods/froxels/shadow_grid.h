// ShadowGrid: which lights reach a place past opaque objects, in voxels of world space that all viewers share. Voxels
// are made where some eye sees them, and made anew when lights or objects have changed: at rest nothing is traced.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/gpu/counts.h"
#include "server/gpu/variants.h"
#include "server/inputs/tick_inputs.h"
#include "shaders/shared/shadow_grid.h"
#include "shaders/shared/types.h"

namespace brume {

// An eye's field of view between its near plane and `far`, widened by so many pixels.
gpu::ShadowEye shadowEye(const gpu::Eye& eye, float far, float margin);

// Lights of the grid, by slot: the sun if it shines, then the strongest local ones that have shadows.
struct ShadowSlots {
    static constexpr uint32_t kSun = gpu::kNoShadowSlot - 1, kMost = gpu::kMostShadowSlots;

    std::vector<uint32_t> lights; // index of a local light, or kSun
    bool operator==(const ShadowSlots&) const = default;
};
// A light that stays among those that are chosen keeps its slot.
ShadowSlots shadowSlots(const gpu::Tick& tick, std::span<const gpu::LocalLight> lights, const ShadowSlots& before);

// Where voxels lie, without lights. Bounds and voxels that are automatic snap to coarse steps, so that bounds that move
// a little leave the grid as it is. A grid above gpu::kLargestBinding gets wider voxels.
gpu::ShadowGridBlock shadowGridShape(const ShadowGridSettings& settings, glm::vec3 lo, glm::vec3 hi, uint32_t slots);

struct ShadowGridInputs {
    const gpu::Resources& resources;         // TickBlock, Objects and what else is shared
    const gpu::Tick& tick;                   // its block, on the CPU
    const TickInputs& shared;                // objects, trees and settings
    std::span<const gpu::LocalLight> lights; // all of the tick
    glm::vec3 lo, hi;                        // m, what the grid covers
    std::span<const gpu::Eye> eyes;          // eyes that will read the grid; more than kMostShadowEyes see all of it
    float far = 0;                           // m of view depth, up to which they read it
    float margin = 0;                        // pixels around pictures, where they read it, too
    uint64_t key = 0;                        // changes whenever objects do
};

class ShadowGrid {
public:
    explicit ShadowGrid(const gpu::Device& device);

    // Makes what these eyes see and is not there. Precondition: nothing of the grid's is on the device, its buffers may
    // be replaced. Ends with its writes visible to all.
    void record(gpu::Commands& commands, const ShadowGridInputs& in);

    // For lib/shadow_grid.glsl.
    const gpu::Buffer& block() const { return block_; }           // gpu::ShadowGridBlock: uniform block
    const gpu::Buffer& voxels() const { return voxels_; }         // uint[]
    const gpu::Buffer& slots() const { return slots_of_lights_; } // uint[]: slot of each local light, or kNoShadowSlot
    const gpu::ShadowGridBlock& shape() const { return shape_; }  // as the last call wrote it
    // A number that changes whenever lights or objects do, and with ShadowGridSettings::retrace at each call.
    uint64_t version() const { return calls_changed_; }
    // Shadow rays of submissions that are done, since the last call of this.
    uint32_t raysSince() { return rays_.since(0); }

private:
    bool fits(const ShadowGridInputs& in, const gpu::ShadowGridBlock& shape, const ShadowSlots& slots) const;

    const gpu::Device& device_;
    gpu::Buffer block_, voxels_, states_, masks_, eyes_, slots_of_lights_;
    gpu::Counts rays_;
    gpu::Variants program_;
    gpu::ShadowGridBlock shape_{};
    ShadowSlots slots_;
    std::vector<uint32_t> slot_of_light_; // slot of each light, or kNoShadowSlot
    std::vector<gpu::ShadowEye> seen_by_; // eyes of the present call
    ShadowGridSettings settings_;
    uint64_t calls_changed_ = 0;
    uint32_t version_ = 0; // version of lights and objects that voxels have; 0: none are made
    uint32_t layer_ = 0;   // with parity: of the next call
    uint64_t key_ = 0;
    uint32_t objects_ = 0, triangles_ = 0;
};

} // namespace brume
