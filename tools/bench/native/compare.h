// Brume's slabs beside the native ones: what Vulkan on this machine costs over vector code written for it.
#pragma once

#include <string>

#include "tools/bench/native/native_slabs.h"
#include "tools/bench/truth.h"

namespace brume::bench {

struct NativeQuestion {
    std::string only;     // scenes whose name holds this
    uint32_t frames = 30; // of each, in turns
    uint32_t threads = 2; // of the native program
};

// Scenes cloud, cloud-5000, plume and cumulus from outside and from within, 640x360, at the rays and slabs that the
// plan takes. Markdown. Says on standard error what it is doing. Throws std::runtime_error when a native picture is
// farther from that of `slabs` than rounding and what both leave out explain.
std::string nativeTable(const gpu::Device& device, Truth& truth, const native::Kernel& kernel,
                        const NativeQuestion& question);

// The table with what was measured, on what and how.
struct NativeRun {
    std::string cpu, device, date, command;
};
std::string nativeReport(const native::Kernel& kernel, const NativeRun& run, const std::string& table);

// Relative RMSE between the two methods' pictures, at most: both leave out particles' tails of `cutoff` optical depth
// in all, but not the same (a sheet of slabs or a slab), and round differently.
inline constexpr double kNativeAgrees = 2e-3;

} // namespace brume::bench
