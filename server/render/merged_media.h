// The merged media (particle_levels.h) that the eyes of a submission ask for, on the device. Eyes that ask for the same share it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/gpu/resource.h"
#include "server/light/particle_light.h"
#include "server/render/particle_levels.h"

namespace brume {

struct EyeRequest;

class MergedMedia {
public:
    struct Medium {
        std::vector<gpu::Particle> list;
        gpu::Buffer particles;                // the list
        gpu::Tick tick{};                     // the scene's, but of so many particles
        gpu::Resource tick_block;             // on the device; the renderer's to set
        MediumExtent extent;                  // of the list
        std::unique_ptr<ParticleLight> light; // when a method reads it

    private:
        friend class MergedMedia;
        int exponent = kNoLevel; // of the cells
        bool wanted = false, fresh = false;
        bool worth = false; // fewer than three quarters
    };

    // For each eye its medium, null where it sees the particles as they are: near ones, or hardly fewer when merged. `ordered`:
    // the tick's particles in SpatialOrder; `moved`: they are not those of the last call. `extent`: theirs.
    void choose(std::span<const gpu::Particle> ordered, bool moved, const gpu::Tick& tick, const MediumExtent& extent,
                std::span<const EyeRequest> eyes, float merge);
    Medium* of(size_t eye) const { return of_eye_[eye]; }
    std::span<Medium* const> media() const { return media_; } // those that some eye has, each once

    // Bytes on their way to the device; write() puts them into `through` from `at` on, record() copies them on.
    VkDeviceSize uploadBytes() const;
    void write(const gpu::Device& device, const gpu::Buffer& through, VkDeviceSize at);
    void record(VkCommandBuffer cmd, const gpu::Buffer& through, VkDeviceSize at);

    void invalidateLight(); // the shadows have changed
    uint64_t cpuBytes() const;

private:
    Medium& merged(std::span<const gpu::Particle> ordered, int exponent, float falloff);

    std::vector<std::unique_ptr<Medium>> all_;
    std::vector<Medium*> of_eye_, media_;
    float falloff_ = 0;
};

} // namespace brume
