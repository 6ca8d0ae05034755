// The device's time for one pass of one submission.
#pragma once

#include <cstdint>

namespace brume::gpu {

inline constexpr uint32_t kShared = ~0u; // the pass is for all views of the submission
inline constexpr uint32_t kEach = ~1u;   // the pass draws several views together

struct PassSample {
    const char* name; // static
    uint32_t view;    // number of the submission's view, or kShared, or kEach
    float ms;
    uint64_t fragments; // shaded, when the device counts them; else 0
};

} // namespace brume::gpu
