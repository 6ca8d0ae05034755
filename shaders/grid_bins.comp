#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Method `grid`, first pass, once per tick. Converts every particle to the form that grid_fill.comp adds to nodes,
// marks the columns, rows and sheets of bricks that it reaches, and marks the bricks that contain medium. One
// workgroup per 32 particles.
#include "shaders/shared/types.h"
#include "shaders/shared/support.h"

layout(local_size_x = 32) in;

#include "shaders/blocks/axes.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer Members { SlabMember members[]; };
layout(scalar) writeonly buffer Skews { Skew skews[]; }; // as members; of ellipsoids
// [columns, rows, sheets][32 particles], then pages; then the same of coarse bricks. All 0 before.
layout(scalar) buffer Bins { uint bins[]; };
layout(scalar) buffer Marks { uint marks[]; };         // lib/grid_marks.glsl; all 0 before

layout(push_constant, scalar) uniform Push { MediumGrid medium; } push;

const float kLog2e = 1.4426950408889634;
// Least variance of a Gaussian on the nodes, spacings^2. Narrower particles are widened, with the same optical mass.
// Their sum over the nodes then varies with the position by at most 2 exp(-2 pi^2 0.36) = 0.2 %.
const float kLeastVariance = 0.36;
const float kCoarseVariance = 4.0 / 3; // spacings^2, added by a B-spline of coarse nodes

#include "shaders/lib/line_bins_write.glsl"
#include "shaders/lib/grid_marks.glsl"

// Marks bricks `a` to `b` in set `set`.
void mark(uint set, ivec3 a, ivec3 b) {
    for (int z = a.z; z <= b.z; ++z)
        for (int y = a.y; y <= b.y; ++y)
            for (int x = a.x / 32 * 32; x <= b.x; x += 32) {
                const uint from = uint(max(a.x - x, 0)), to = uint(min(b.x - x, 31));
                atomicOr(marks[markWord(set, uvec3(x, y, z))], (0xffffffffu >> (31 - to)) & (0xffffffffu << from));
            }
}

void main() {
    const MediumGrid medium = push.medium;
    const uvec3 coarse_bricks = coarseBricks();
    const uint i = gl_WorkGroupID.x * 32 + laneOfWord();
    ivec2 reach[3] = ivec2[](ivec2(1, 0), ivec2(1, 0), ivec2(1, 0)), coarse_reach[3] = reach;
    if (i < tick.particle_count) {
        const Particle p = particles[i];
        const float u = p.scale * tick.falloff, own = max(0.1 * u / medium.spacing, 1e-12);
        const vec3 at = (p.centre - medium.origin) / medium.spacing; // in nodes
        vec3 owns = vec3(own); // of each axis
        if (kEllipsoids) owns *= vec3(length(axes[i].a), length(axes[i].b), length(axes[i].c));
        const bool is_coarse = min(owns.x, min(owns.y, owns.z)) >= medium.least_coarse;
        const float held = is_coarse ? 0.5 * sqrt(own * own - medium.variance - kCoarseVariance)
                                     : sqrt(max(own * own - medium.variance, kLeastVariance));
        const float own_nodes = is_coarse ? 0.5 * own : own; // the deviation, in its nodes' spacings
        SlabMember m;
        m.centre = is_coarse ? inCoarse(at) : at;
        m.across = m.along = 0.5 * kLog2e / (held * held);
        m.sigma = p.sigma_t * (own_nodes / held) * (own_nodes / held) * (own_nodes / held);
        m.albedo = p.albedo;
        m.reach = 0; // not read
        vec3 deviations = vec3(held); // along x, y and z
        if (kEllipsoids) {
            const float nodes = is_coarse ? 0.5 : 1;
            const vec3 squares = is_coarse ? owns * owns - medium.variance - kCoarseVariance
                                           : max(owns * owns - medium.variance, vec3(kLeastVariance));
            // The axes with the deviations that nodes hold; slicedGaussian() wants them over the longest.
            const vec3 holds = nodes * sqrt(squares);
            const float longest = max(holds.x, max(holds.y, holds.z));
            const vec3 parts = holds / (longest * owns / own);
            const SlicedGaussian cut =
                slicedGaussian(longest, parts.x * axes[i].a, parts.y * axes[i].b, parts.z * axes[i].c);
            const float unit = 0.5 * kLog2e / acrossDeterminant(cut);
            m.along = 0.5 * kLog2e / cut.along;
            m.sigma = p.sigma_t * (nodes * owns.x / holds.x) * (nodes * owns.y / holds.y) * (nodes * owns.z / holds.z);
            skews[i] = Skew(unit * cut.yy, -unit * cut.xy, unit * cut.xx, vec2(cut.tilt_x, cut.tilt_y));
            deviations = sqrt(vec3(cut.xx, cut.yy, varianceAlong(cut)));
        }
        members[i] = m;
        const float support = supportRadius(p.sigma_t, u, tick.cut) / medium.spacing, // spacings
                    radius = support * max(held / own_nodes, 1);                      // of what is sampled
        if (radius > 0) {
            const vec3 own_radius = support / own * deviations; // of what its nodes hold, in their spacings
            const vec3 first = (m.centre - own_radius) / float(kSlabTile) - 1e-3,
                       last = (m.centre + own_radius) / float(kSlabTile) + 1e-3;
            for (uint axis = 0; axis < 3; ++axis) {
                if (is_coarse) coarse_reach[axis] = span(first[axis], last[axis], coarse_bricks[axis]);
                else reach[axis] = span(first[axis], last[axis], medium.bricks[axis]);
            }
            // A sample in cell c reads nodes c - 1 ... c + 2. So a particle is seen from two cells before it to one
            // cell behind it, and the cells of a marked brick read from one node before the brick to two nodes behind
            // it.
            const ivec3 end = ivec3(medium.bricks) - 1;
            const ivec3 from = clamp(ivec3(floor((at - radius - 2) / float(kSlabTile))), ivec3(0), end),
                        to = clamp(ivec3(floor((at + radius + 1) / float(kSlabTile))), ivec3(0), end);
            const ivec3 from_read = max(from - 1, ivec3(0)), to_read = min(to + 1, end);
            mark(kSampled, from, to);
            mark(kRead, from_read, to_read);
            mark(kReadCoarse, firstCoarse(from_read), lastCoarse(to_read));
        }
    }
    writeBins(0, reach, medium.bricks);
    writeBins(lineWords(medium.bricks, gl_NumWorkGroups.x), coarse_reach, coarse_bricks);
}
