#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "shaders/lib/sort.glsl"

layout(scalar) readonly buffer Keys { uint keys[]; };
layout(scalar) writeonly buffer Histogram { uint histogram[]; }; // [digit][block]

void main() {
    const uint thread = gl_LocalInvocationIndex;
    countDigits(thread, gl_WorkGroupID.x * kBlock + thread * kKeysPerThread);
    barrier();
    if (thread >= kDigits) return;
    uint sum = 0;
    for (uint t = 0; t < kThreads; ++t) sum += counts[thread * kThreads + t];
    histogram[thread * push.blocks + gl_WorkGroupID.x] = sum;
}
