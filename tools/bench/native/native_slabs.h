// The method `slabs` (server/methods/slabs) written straightforwardly for the CPU's vector units, as a yardstick of
// what Vulkan's share of the same work costs on this machine: particles binned in tiles of 8x8 rays, Gaussians added by
// recurrence along them, light looked up per slab, a cubic B-spline to every pixel.
#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "tools/bench/native/kernel.h"
#include "tools/bench/stage.h"

namespace brume::bench {

class NativeSlabs {
public:
    // The kernel of that name, of "" the widest; null where the CPU lacks its instructions, or has none that there is a
    // kernel for.
    static const native::Kernel* named(std::string_view name);
    // Whether this CPU runs the kernel.
    static bool runs(const native::Kernel& kernel);

    // The stage's scene now, seen by its first viewer. Precondition: runs(kernel); `rate` (a power of two) and `slabs`
    // as RenderSettings, none 0. Throws std::runtime_error for what this program leaves out: opaque objects, a lobe,
    // ambient light, several albedos, a medium in which the camera's near plane leaves nothing to see.
    NativeSlabs(const Stage& stage, glm::uvec2 size, uint32_t rate, uint32_t slabs, const native::Kernel& kernel,
                uint32_t threads);

    // A picture: bins, tiles, reconstruction. The light's map is made once, by the constructor: it belongs to the tick.
    void render();
    RadianceImage picture() const; // of the last render()

    // What each part of the last render() took, ms; those of one tile after the other as the threads' mean.
    struct Spent {
        double bin = 0, slabs = 0, light = 0, rows = 0;
    };
    const Spent& spent() const { return spent_; }
    // Places at which a particle's extinction was computed, of the last render().
    uint64_t samples() const;

private:
    template <class Barrier>
    void work(uint32_t thread, Barrier& together);
    void bin(uint32_t thread);
    void fitSpline(uint32_t y);
    void mapLight(const std::vector<gpu::Particle>& particles);

    const native::Kernel& kernel_;
    const uint32_t threads_;
    const std::vector<gpu::Particle> particles_;
    gpu::Tick tick_;
    MediumExtent extent_;
    Pose pose_;
    glm::uvec2 size_, tiles_, nodes_; // pixels; of rays; those that a tile or the picture needs
    native::Frame frame_{};
    std::vector<native::Member> members_;
    std::vector<std::vector<std::vector<uint32_t>>> lists_; // [thread][tile]: members that it may reach
    std::vector<std::vector<float>> scratch_;               // [thread]
    std::vector<float> light_, field_[2], spline_[2], weights_[4], picture_[4];
    std::atomic<uint32_t> next_tile_{0}, next_row_{0};
    std::vector<Spent> thread_spent_; // of tiles
    Spent spent_;
};

} // namespace brume::bench
