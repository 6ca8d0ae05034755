#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/lib/sort.glsl"

layout(scalar) readonly buffer Keys { uint keys[]; };
layout(scalar) readonly buffer Values { uint values[]; };
layout(scalar) readonly buffer Histogram { uint histogram[]; }; // exclusive prefix sums
layout(scalar) writeonly buffer KeysOut { uint keys_out[]; };
layout(scalar) writeonly buffer ValuesOut { uint values_out[]; };

void main() {
    const uint thread = gl_LocalInvocationIndex;
    const uint first = gl_WorkGroupID.x * kBlock + thread * kKeysPerThread;
    countDigits(thread, first);
    barrier();
    if (thread < kDigits) { // position of each thread's first key with this digit
        uint offset = histogram[thread * push.blocks + gl_WorkGroupID.x];
        for (uint t = 0; t < kThreads; ++t) {
            const uint here = counts[thread * kThreads + t];
            counts[thread * kThreads + t] = offset;
            offset += here;
        }
    }
    barrier();
    const uint end = min(first + kKeysPerThread, push.count);
    for (uint i = first; i < end; ++i) {
        const uint key = keys[i];
        const uint slot = digitOf(key) * kThreads + thread;
        const uint to = counts[slot];
        counts[slot] = to + 1;
        keys_out[to] = key;
        values_out[to] = values[i];
    }
}
