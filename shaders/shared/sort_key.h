// Depth keys whose unsigned order is "far to near", for any finite or infinite depth. Compiled as C++ and as GLSL.
#ifndef BRUME_SHARED_SORT_KEY_H
#define BRUME_SHARED_SORT_KEY_H

#ifdef __cplusplus
#include <bit>
#include <cstdint>
namespace brume::gpu {
using uint = uint32_t;
#define BRUME_INLINE inline
inline uint floatBitsToUint(float x) { return std::bit_cast<uint>(x); }
#else
#define BRUME_INLINE
#endif

// Key of a particle that is not drawn: after all other keys.
const uint kDropped = 0xFFFFFFFFu;

// Farther depths get smaller keys; equal depths (and -0, +0) get equal keys; NaN gets kDropped.
BRUME_INLINE uint sortKeyFarToNear(float depth) {
    if (!(depth == depth)) return kDropped;
    const uint bits = floatBitsToUint(depth == 0.0f ? 0.0f : depth);
    const uint ascending = (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u; // order-preserving for floats
    return ~ascending; // -inf gives 0xFF7FFFFF, so kDropped stays free
}

#ifdef __cplusplus
} // namespace brume::gpu
#endif
#undef BRUME_INLINE
#endif
