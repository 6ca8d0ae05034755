#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Volumetric shadow map, second pass: tau at every texel of 16 slice planes, summed over the particles that reach its tile.
// A layer holds four planes and shares its last with the next layer's first, so 16 planes are five layers.
// One workgroup per 16x16 tile; it bins the particles as it goes, in order, so that sums are the same on every run.
// A lane owns 4 texels of a column on all 16 planes, so that one load of a particle serves 64 multiply-adds.
#include "shaders/shared/types.h"

layout(local_size_x = 16, local_size_y = 4) in;

const uint kPlanes = 16;
const uint kLanes = 64;
const uint kPerLane = 4;                  // particles tested by one lane at a time
const uint kChunk = kLanes * kPerLane;
const uint kRows = 4;                     // texels of one lane

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 3) readonly buffer LightParticles { LightParticle light_particles[]; };
layout(scalar, binding = 4) readonly buffer Columns { vec4 columns[]; }; // [particle][kPlanes / 4]
layout(rgba32f, binding = 5) writeonly uniform image2DArray volume;

layout(push_constant, scalar) uniform Push { uint first_plane; } push;

shared uint found[kLanes];           // how many of the lane's particles reach the tile, then where its list begins
shared uint members[kChunk];
shared uint member_count;

bool reaches(LightParticle p, vec2 lo, vec2 hi) {
    const vec2 d = p.centre - clamp(p.centre, lo, hi);
    return p.radius > 0 && dot(d, d) < p.radius * p.radius;
}

void main() {
    const uint lane = gl_LocalInvocationIndex;
    const vec2 texel = (tick.shadow_hi.xy - tick.shadow_lo.xy) / float(tick.shadow_size);
    const vec2 tile_lo = tick.shadow_lo.xy + vec2(gl_WorkGroupID.xy * 16) * texel, tile_hi = tile_lo + 16 * texel;
    const uvec2 first = gl_WorkGroupID.xy * 16 + uvec2(gl_LocalInvocationID.x, gl_LocalInvocationID.y * kRows);
    const vec2 centre = tick.shadow_lo.xy + (vec2(first) + 0.5) * texel;

    vec4 sum[kRows][kPlanes / 4];
    for (uint r = 0; r < kRows; ++r)
        for (uint q = 0; q < kPlanes / 4; ++q) sum[r][q] = vec4(0);

    for (uint chunk = 0; chunk < tick.particle_count; chunk += kChunk) {
        uint mine[kPerLane];
        uint count = 0;
        for (uint j = 0; j < kPerLane; ++j) {
            const uint i = chunk + lane * kPerLane + j;
            if (i < tick.particle_count && reaches(light_particles[i], tile_lo, tile_hi)) mine[count++] = i;
        }
        found[lane] = count;
        barrier();
        if (lane == 0) {
            uint total = 0;
            for (uint l = 0; l < kLanes; ++l) {
                const uint here = found[l];
                found[l] = total;
                total += here;
            }
            member_count = total;
        }
        barrier();
        for (uint j = 0; j < count; ++j) members[found[lane] + j] = mine[j];
        barrier();
        for (uint m = 0; m < member_count; ++m) {
            const uint i = members[m];
            const LightParticle p = light_particles[i];
            const vec4 c0 = columns[i * 4], c1 = columns[i * 4 + 1], c2 = columns[i * 4 + 2], c3 = columns[i * 4 + 3];
            const float dx = (centre.x - p.centre.x) * p.k;
            for (uint r = 0; r < kRows; ++r) {
                const float dy = (centre.y + float(r) * texel.y - p.centre.y) * p.k;
                const float weight = exp(-dx * dx - dy * dy);
                sum[r][0] += weight * c0;
                sum[r][1] += weight * c1;
                sum[r][2] += weight * c2;
                sum[r][3] += weight * c3;
            }
        }
        barrier();
    }
    const ivec3 size = imageSize(volume);
    for (uint r = 0; r < kRows; ++r) {
        const vec4 layers[5] = vec4[](sum[r][0], vec4(sum[r][0].w, sum[r][1].xyz), vec4(sum[r][1].zw, sum[r][2].xy),
                                      vec4(sum[r][2].yzw, sum[r][3].x), sum[r][3]);
        for (uint l = 0; l < 5; ++l) {
            const ivec3 at = ivec3(first.x, first.y + r, push.first_plane / 3 + l);
            if (all(lessThan(at, size))) imageStore(volume, at, layers[l]);
        }
    }
}
