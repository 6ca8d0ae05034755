#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Cells of the plane across the sun's rays (UnionBalls): sets a particle's bit in every cell that its ball may cover.
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) buffer UnionBits { uint union_bits[]; }; // [row][column][word], all 0

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i >= tick.particle_count) return;
    const UnionBalls balls = tick.balls;
    const Particle p = particles[i];
    const vec2 at = (vec2(dot(tick.map.x, p.centre), dot(tick.map.y, p.centre)) - balls.lo) / balls.cell;
    const float reach = 1.001 * balls.radius * p.scale / balls.cell + 1e-3; // more than rounding takes
    const uint last = balls.side - 1;
    const uvec2 lo = uvec2(clamp(at - reach, vec2(0), vec2(last))), hi = uvec2(clamp(at + reach, vec2(0), vec2(last)));
    for (uint y = lo.y; y <= hi.y; ++y)
        for (uint x = lo.x; x <= hi.x; ++x)
            atomicOr(union_bits[(y * balls.side + x) * balls.words + i / 32], 1u << (i % 32));
}
