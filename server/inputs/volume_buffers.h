// VolumeBuffers: the voxels of a volume as nodes in device memory, of the form that methods read (medium_grid.h).
#pragma once

#include <memory>

#include "common/volume/volume.h"
#include "server/gpu/resource.h"
#include "shaders/shared/types.h"

namespace brume {

class VolumeBuffers {
public:
    // `centre`: what the voxels are moved by, m.
    VolumeBuffers(const gpu::Device& device, std::shared_ptr<const Volume> volume, glm::vec3 centre);

    // The voxels' extinction is multiplied by this. Waits for the device if it is another than before. Precondition:
    // nothing of it is on the device.
    void follow(float times);

    const gpu::MediumGrid& grid() const { return grid_; }
    const gpu::Buffer& nodes() const { return nodes_; } // float[plane][row][node], 1/m
    const gpu::Buffer& marks() const { return marks_; } // shaders/lib/grid_marks.glsl; all bricks count as read

private:
    void makeMarks();

    const gpu::Device& device_;
    std::shared_ptr<const Volume> volume_;
    gpu::MediumGrid grid_{};
    gpu::Buffer nodes_, marks_;
    float times_ = -1; // that the nodes have
};

} // namespace brume
