#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Method `slabs`, first pass, per eye. Converts every particle to the form that slabs.comp adds, and marks the columns
// and rows of tiles that it may reach, one bit per particle and line. One workgroup per 32 particles.
#include "shaders/shared/types.h"
#include "shaders/shared/erf.h"
#include "shaders/shared/support.h"
#include "shaders/shared/widened.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 32) in;

#include "shaders/blocks/axes.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer Members { SlabMember members[]; };
layout(scalar) writeonly buffer Skews { Skew skews[]; }; // as members; of ellipsoids
// [columns, rows][32 particles], then pages; all 0 before.
layout(scalar) buffer Bins { uint bins[]; };

const float kLog2e = 1.4426950408889634;
// Least standard deviation of a particle, in spacings of rays and slabs. Narrower particles are widened, with the
// same optical mass. With one ray per pixel nothing is widened: a pixel is then a point, as with every method.
const float kLeastAcross = 0.7, kLeastAlong = 0.7;
// Most -log2 of a Gaussian from the middle to the border of a tile, for recurrences that begin in the middle. With it a
// particle beside the tile, whose value there is no float32 any more, has less than 2^-20 of its peak at the border.
const float kMostSpread = 40;
// -log2 of a Gaussian's part of its peak, on planes beyond which a tile's width does not matter to it.
const float kMostFade = 20;

#include "shaders/lib/frustum.glsl"
#include "shaders/lib/line_bins_write.glsl"

// A direction as the members' coordinates have it: right, down, away from the eye.
vec3 inView(vec3 v) { return vec3(dot(eye.right, v), -dot(eye.up, v), -dot(eye.back, v)); }

void main() {
    enterView(gl_WorkGroupID.z);
    const uint i = gl_WorkGroupID.x * 32 + laneOfWord();
    const float pixel = 2 * eye.tan_y / float(eye.size.y); // m per m of view depth
    const float tile = float(grid.rate * kSlabTile) * pixel;
    ivec2 reach[3] = ivec2[](ivec2(1, 0), ivec2(1, 0), ivec2(1, 0)); // without sheets: members know them
    if (i < tick.particle_count) {
        const Particle p = particles[i];
        const float u = p.scale * tick.falloff, own = max(0.1 * u, 1e-18);
        const vec3 c = p.centre - eye.position;
        SlabMember m;
        m.centre = inView(c);
        const float least = grid.rate > 1 ? kLeastAcross * float(grid.rate) * pixel * m.centre.z : 0;
        const float across = max(own, least), along = max(own, kLeastAlong * slabThickness());
        m.across = 0.5 * kLog2e / (across * across);
        m.along = 0.5 * kLog2e / (along * along);
        m.sigma = p.sigma_t * (own / across) * (own / across) * (own / along);
        if (along > own) m.sigma *= widenedShare(own, along, grid.depth - m.centre.z, farDepth() - m.centre.z);
        m.albedo = p.albedo;
        m.reach = 1;
        const float radius = supportRadius(p.sigma_t, u, tick.cut);
        vec2 wide = vec2(radius * across / own);
        float deep = radius * along / own, curvature = m.across;
        if (kEllipsoids) {
            const float thick = kLeastAlong * slabThickness();
            SlicedGaussian cut = slicedGaussian(own, inView(axes[i].a), inView(axes[i].b), inView(axes[i].c));
            m.sigma = p.sigma_t * sqrt(acrossDeterminant(cut) * cut.along);
            cut = widenedAcross(cut, least * least);
            const float narrow = sqrt(cut.along), widened = max(narrow, thick);
            if (widened > narrow)
                m.sigma *= widenedShare(narrow, widened, grid.depth - m.centre.z, farDepth() - m.centre.z);
            cut.along = widened * widened;
            const float determinant = acrossDeterminant(cut), unit = 0.5 * kLog2e / determinant;
            m.sigma *= inversesqrt(determinant * cut.along);
            m.along = 0.5 * kLog2e / cut.along;
            skews[views[gl_WorkGroupID.z].members + i] =
                Skew(unit * cut.yy, -unit * cut.xy, unit * cut.xx, vec2(cut.tilt_x, cut.tilt_y));
            wide = radius / own * sqrt(vec2(cut.xx, cut.yy));
            deep = radius / own * sqrt(varianceAlong(cut));
            curvature = unit * cut.yy + m.along * cut.tilt_x * cut.tilt_x;
        }
        const float end = farDepth();
        const float near = max(m.centre.z - deep, grid.depth), far = min(m.centre.z + deep, end);
        if (radius > 0 && far > near) {
            // The box around the particle in the picture, in tiles from node (0, 0).
            const vec2 lo = m.centre.xy - wide, hi = m.centre.xy + wide;
            const vec2 origin =
                pictureCorner() + (0.5 + (vec2(0, grid.first_row) - float(grid.margin)) * float(grid.rate)) * pixel;
            const vec2 first = (min(lo / near, lo / far) - origin) / tile - 1e-3,
                       last = (max(hi / near, hi / far) - origin) / tile + 1e-3;
            reach[0] = span(first.x, last.x, grid.lines.x);
            reach[1] = span(first.y, last.y, grid.lines.y);
            const ivec2 sheets = span(sheetAt(near), sheetAt(far), grid.lines.z);
            const float fades = kEllipsoids ? deep : sqrt(kMostFade / m.along);
            const float reached = clamp(m.centre.z + fades, 0, middleDepth(grid.slabs - 1));
            const float half_tile = reached * 0.5 * tile;
            if (sheets.x <= sheets.y)
                m.reach = uint(sheets.x) | uint(sheets.y) << 16 |
                          (curvature * half_tile * half_tile > kMostSpread ? kSmallMember : 0);
        }
        members[views[gl_WorkGroupID.z].members + i] = m;
    }
    writeBins(views[gl_WorkGroupID.z].bins, reach, uvec3(grid.lines.xy, 0));
}
