// The levels of detail (medium/levels.h) that the eyes of a submission ask for, on the device. Eyes that ask for the
// same level share it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "server/gpu/resource.h"
#include "server/inputs/eye_request.h"
#include "server/inputs/medium_view.h"
#include "server/medium/levels.h"

namespace brume {

class MergedMedia {
public:
    struct Medium {
        std::vector<gpu::Particle> list;
        gpu::Buffer particles;   // the list on the device
        gpu::Tick tick{};        // the scene's, with this list's particle_count
        MediumExtent extent;     // of the list
        MediumView view;         // of all that; set by TickUpload
        int exponent = kNoLevel; // of the cells

    private:
        friend class MergedMedia;
        bool wanted = false; // True: an eye of this submission sees it
        bool fresh = false;  // True: it is not on the device yet
        bool worth = false;  // True: it has fewer than three quarters of the particles
    };

    // Chooses each eye's level: none for an eye that is near, or for which merging would save little. `ordered`: the
    // tick's particles in SpatialOrder, `extent` of them. `moved`: True if they are not those of the last call.
    void choose(std::span<const gpu::Particle> ordered, bool moved, const gpu::Tick& tick, const MediumExtent& extent,
                std::span<const EyeRequest> eyes, float merge);
    Medium* of(size_t eye) const { return of_eye_[eye]; }     // null: it sees the particles as they are
    std::span<Medium* const> media() const { return media_; } // those that some eye has, each once

    // Bytes on their way to the device; write() puts them into `through` from byte `at` on, record() copies them on.
    VkDeviceSize uploadBytes() const;
    void write(const gpu::Device& device, const gpu::Buffer& through, VkDeviceSize at);
    void record(VkCommandBuffer cmd, const gpu::Buffer& through, VkDeviceSize at) const;

    uint64_t cpuBytes() const;

private:
    Medium& merged(std::span<const gpu::Particle> ordered, int exponent, float falloff);

    std::vector<std::unique_ptr<Medium>> all_;
    std::vector<Medium*> of_eye_, media_;
    float falloff_ = 0;
};

} // namespace brume
