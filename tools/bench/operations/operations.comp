#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#extension GL_KHR_shader_subgroup_ballot : require
#extension GL_KHR_shader_subgroup_shuffle : require
// One operation, again and again: push.rounds times a lane. Its inputs come from the round and from what it gave
// before, so that none is computed once for all rounds.
#include "tools/bench/operations/names.h"

layout(local_size_x = 64) in;

layout(constant_id = kIdOperation) const uint kOperation = 0;
layout(constant_id = kIdPattern) const uint kPattern = 0;

layout(scalar) readonly buffer Floats { float floats[]; };
layout(scalar) readonly buffer Pairs { vec2 pairs[]; };
layout(scalar) readonly buffer Vectors { vec4 vectors[]; };
layout(scalar) buffer Stored { float stored[]; };
layout(scalar) buffer StoredVectors { vec4 stored_vectors[]; };
layout(scalar) buffer Counts { uint counts[]; };
uniform sampler2DArray one, four; // r32f and rgba32f
layout(rgba32f) writeonly uniform image2D drawn;
layout(scalar) writeonly buffer Results { float results[]; };

layout(push_constant, scalar) uniform Push {
    uint rounds;
    uint mask;  // elements of a buffer - 1: 2^n - 1
    uint width; // of images, a power of two
    uint two;   // 2, which no compiler knows
} push;

shared float held[256];

uint indexOf(uint round) {
    const uint lane = gl_GlobalInvocationID.x;
    if (kPattern == kUniform) return round & push.mask;
    if (kPattern == kScattered) return ((lane * 2654435761u + round * 40503u) >> 7) & push.mask;
    return (lane + round * 64) & push.mask;
}

float sixteen(float x) {
    [[unroll]] for (uint i = 0; i < 16; ++i) x = exp2(-x);
    return x;
}

void main() {
    const uint lane = gl_SubgroupID * gl_SubgroupSize + gl_SubgroupInvocationID;
    float x = float(lane) * 0.01;
    float sums[16];
    [[unroll]] for (uint i = 0; i < 16; ++i) sums[i] = 0;
    held[lane] = x;
    barrier();
    uint round = 0;
    do {
        const uint at = indexOf(round);
        const vec3 point = vec3(vec2(at & (push.width - 1), at / 64) + 0.3, 0) / vec3(push.width, push.width, 1);
        const ivec3 texel = ivec3(at & (push.width - 1), (at >> 6) & (push.width - 1), 0);
        switch (kOperation) {
        case kNothing: x += float(at); break;
        case kLoadFloat: x += floats[at]; break;
        case kLoadVec2: x += dot(pairs[at], vec2(1)); break;
        case kLoadVec4: x += dot(vectors[at], vec4(1)); break;
        case kStoreFloat: stored[at] = x; break;
        case kStoreVec4: stored_vectors[at] = vec4(x); break;
        case kAtomicAdd: atomicAdd(counts[at], 1u); break;
        case kFetchFloat: x += texelFetch(one, texel, 0).r; break;
        case kFetchVec4: x += dot(texelFetch(four, texel, 0), vec4(1)); break;
        case kLinearFloat: x += textureLod(one, point, 0).r; break;
        case kLinearVec4: x += dot(textureLod(four, point, 0), vec4(1)); break;
        case kGather: x += dot(textureGather(one, point), vec4(1)); break;
        case kImageStore: imageStore(drawn, texel.xy, vec4(x)); break;
        case kDivide: x = 1 / (x + 2); break;
        case kRoot: x = sqrt(x + 2); break;
        case kExp2: x = exp2(-x); break;
        case kLog2: x = log2(x + 2); break;
        case kSine: x = sin(x); break;
        case kDivideWhole: x += float(at / (push.two + (round & 1))); break;
        case kBroadcast: x += subgroupBroadcastFirst(x); break;
        case kShuffle: x += subgroupShuffle(x, (gl_SubgroupInvocationID + round) % gl_SubgroupSize); break;
        case kSumOfSubgroup: x = subgroupAdd(x) * 0.01; break;
        case kBallot: x += float(subgroupBallot(x < float(round)).x); break;
        case kLocalIndex: x += held[(gl_LocalInvocationIndex + round) & 63]; break;
        case kSubgroupIndex: x += held[(lane + round) & 63]; break;
        case kLocalIndexAfter:
            barrier();
            x += held[(gl_LocalInvocationIndex + round) & 63];
            break;
        case kSubgroupIndexAfter:
            barrier();
            x += held[(lane + round) & 63];
            break;
        case kBarrier:
            barrier();
            x += float(at);
            break;
        case kSubgroupBarrier:
            subgroupBarrier();
            x += float(at);
            break;
        case kMemoryBarrier:
            memoryBarrierShared();
            x += float(at);
            break;
        case kTaken:
            if (push.two == 2) x = sixteen(x);
            break;
        case kSkipped:
            if (push.two == 3) x = sixteen(x);
            break;
        case kSkippedByLane:
            if (x > 1e30) x = sixteen(x);
            break;
        case kFor:
            [[dont_unroll]] for (uint i = 0; i < push.two; ++i) x = sixteen(x);
            break;
        case kDo: {
            uint i = 0;
            [[dont_unroll]] do { x = sixteen(x); } while (++i < push.two);
            break;
        }
        case kDiverging: {
            uint i = 0;
            [[dont_unroll]] do { x = sixteen(x); } while (++i < push.two + (lane & 3) - 1);
            break;
        }
        case kSums:
            [[unroll]] for (uint i = 0; i < 16; ++i) sums[i] += x * float(i + round);
            break;
        case kSumsChosen: sums[round & 15] += x; break;
        }
    } while (++round < push.rounds);
    [[unroll]] for (uint i = 0; i < 16; ++i) x += sums[i];
    results[gl_GlobalInvocationID.x] = x;
}
