// Probe: reads the radiance of some pixels of a picture back, for the server's own estimate of its error.
#pragma once

#include <span>
#include <vector>

#include "server/gpu/variants.h"
#include "server/inputs/scene_features.h"
#include "server/inputs/view_group.h"

namespace brume {

inline constexpr uint32_t kMostProbes = 256; // pixels of a submission

// What one submission reads back.
struct ProbeReading {
    uint32_t eye = 0;               // its number in the submission
    std::vector<glm::uvec2> pixels; // at most kMostProbes, of the finished picture
    // True: the pixels are those that were drawn, with sky and surfaces behind and with ambient light. False: the
    // medium in front of black, without ambient light.
    bool drawn = false;

    // Radiance (RGB) and transmittance of each pixel. Precondition: the device is done with the submission.
    std::span<const glm::vec4> values();

private:
    friend class Probe;
    gpu::Buffer where_, values_;
};

class Probe {
public:
    explicit Probe(const gpu::Device& device);

    // Makes room, and copies the pixels. Precondition: the device does not use `reading`.
    void prepare(ProbeReading& reading) const;
    // Reads the pixels of the group's views that belong to the eye. After the group was drawn, and before another is.
    void record(gpu::Commands& commands, const ViewGroup& group, ProbeReading& reading, const gpu::View& eye);

private:
    const gpu::Device& device_;
    gpu::Variants program_;
};

} // namespace brume
