// FroxelHistory: what cells of an eye's last picture had, for FroxelSettings::history. Each eye has its own, found by
// EyeInputs::history.
#pragma once

#include <map>

#include "server/gpu/commands.h"
#include "server/inputs/eye_inputs.h"
#include "shaders/shared/froxels.h"

namespace brume {

class FroxelHistory {
public:
    explicit FroxelHistory(const gpu::Device& device);

    // What froxels.comp is bound to. Without buffers of an eye: some that are not read.
    struct Bound {
        bool has = false; // True: the eye's cells keep a part of its last picture
        const gpu::Buffer* cells = nullptr;
        const gpu::Buffer* block = nullptr; // gpu::HistoryBlock
    };
    // Records what cells of an eye's picture need. None where the setting is 0, the eye has no number, its picture is
    // made in bands, its cells take more than 96 MiB (1600x900 at the defaults), or those of all eyes 512 MiB.
    // Precondition: nothing of the eyes' is on the device.
    Bound record(gpu::Commands& commands, const EyeInputs& in, const gpu::FroxelGrid& froxels, bool whole);
    // Forgets eyes that have had no picture for a while. Once a submission.
    void forgetOld();

private:
    struct Eye {
        gpu::Buffer cells, block;
        gpu::Eye eye{};
        gpu::FroxelGrid froxels{};
        bool known = false;  // True: it has had a picture of this size
        bool second = false; // True: the last picture's cells are in the second half
        uint64_t seen = 0;   // submission of the last picture
    };

    const gpu::Device& device_;
    gpu::Buffer nobodys_cells_, nobodys_block_;
    std::map<uint64_t, Eye> eyes_;
    uint64_t submission_ = 0;
};

} // namespace brume
