#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `march`, the blur, once along rows and once down columns: a filter that leaves out neighbours whose depth
// differs. A lane owns a run of pixels, so that it reads each of their neighbours once.
#include "shaders/shared/constants.h"
#include "shaders/shared/march.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = kIdBlur) const uint kBlur = kBlurRow14;
layout(constant_id = kIdDown) const bool kDown = false;

layout(scalar) readonly buffer Ends { float ends[]; }; // [row][column]: m of view depth
layout(scalar) readonly buffer From { vec4 from[]; };  // [row][column]: light, opacity
layout(scalar) writeonly buffer To { vec4 to[]; };

layout(push_constant, scalar) uniform Push { MarchBand band; } push;

#include "shaders/lib/depth_weight.glsl"

const int kRun = 8; // pixels of a lane
const int kReach = int(kBlurReach), kRead = kRun + 2 * kReach;
const float kNowhere = 1e30; // depth beyond the edge of the picture: it counts nothing

void main() {
    const uvec2 id = gl_GlobalInvocationID.xy, size = push.band.size;
    const uint line = kDown ? id.x : id.y, lines = kDown ? size.x : size.y;
    const int first = kRun * int(kDown ? id.y : id.x), count = int(kDown ? size.y : size.x);
    if (line >= lines || first >= count) return;
    const uint step = kDown ? size.x : 1, base = kDown ? line : line * size.x;
    vec4 value[kRead];
    float depth[kRead];
    [[unroll]] for (int i = 0; i < kRead; ++i) {
        const int at = first + i - kReach, inside = clamp(at, 0, count - 1);
        value[i] = from[base + uint(inside) * step];
        depth[i] = at == inside ? ends[base + uint(inside) * step] : kNowhere;
    }
    [[unroll]] for (int o = 0; o < kRun; ++o) {
        const int own = o + kReach;
        const float slope = slopeOf(depth[own - 1], depth[own], depth[own + 1]);
        // Differences from the own value are summed: a pixel without neighbours keeps its bits.
        vec4 sum = vec4(0);
        float weights = kBlurWeights[kBlur][kReach];
        [[unroll]] for (int k = -kReach; k <= kReach; ++k) {
            if (k == 0 || kBlurWeights[kBlur][k + kReach] == 0) continue;
            const float off = depth[own + k] - depth[own] - slope * float(k);
            const float weight = kBlurWeights[kBlur][k + kReach] * depthWeight(off);
            sum += weight * (value[own + k] - value[own]);
            weights += weight;
        }
        if (first + o < count) to[base + uint(first + o) * step] = value[own] + sum / weights;
    }
}
