// PassSample: the device's time for one pass of one submission.
#pragma once

#include <cstdint>

namespace brume::gpu {

inline constexpr uint32_t kShared = ~0u; // PassSample::view: the pass serves all views of the submission
inline constexpr uint32_t kEach = ~1u;   // PassSample::view: the pass draws several views together

struct PassSample {
    const char* name; // static string
    uint32_t view;    // index of the view in the submission, or kShared, or kEach
    float ms;
    uint64_t fragments; // number of shaded fragments; 0 unless the device counts them
};

} // namespace brume::gpu
