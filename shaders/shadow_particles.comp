#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Volumetric shadow map, first pass: converts every particle to the map's cells and marks the tiles that it reaches.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/transmittance.h"
#include "shaders/shared/sharpen.h"
#include "shaders/shared/support.h"

layout(local_size_x = 32) in;

layout(constant_id = kIdLanes) const uint kColumns = 8; // texels of a tile's width

#include "shaders/blocks/axes.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) writeonly buffer LightParticles { LightParticle light_particles[]; };
layout(scalar) writeonly buffer LightSkews { Skew light_skews[]; }; // of ellipsoids
layout(scalar) buffer Bins { uint bins[]; };

layout(constant_id = kIdFronts) const bool kFronts = false;

layout(push_constant, scalar) uniform Push {
    uvec3 tiles; // columns, rows, groups of planes
} push;

#include "shaders/lib/shadow_bins.glsl"
#include "shaders/lib/line_bins_write.glsl"

// Least variance across of what texels hold, cells^2: their sum then varies with the place by 2 % at most.
const float kLeastVariance = 0.23;

const float kSharp = 100; // 1 / planes: erfc() half a plane from such a Gaussian is 0 or 2

vec3 inPlanes(vec3 v) { return vec3(dot(tick.map.x, v), dot(tick.map.y, v), -dot(tick.sun.to_light, v)); }

// An ellipsoid in the map's cells, sharpened. `s`: deviation along its longest axis, m. Sets what differs in `light`.
Skew skewOf(EllipsoidAxes own, float s, vec3 cell, float sigma_t, inout LightParticle light, out vec3 deviations) {
    SlicedGaussian cut = slicedGaussian(s, inPlanes(own.a), inPlanes(own.b), inPlanes(own.c));
    const float column = sigma_t * sqrt(cut.along) * 2.5066282746;
    const vec3 variance = vec3(cut.xx, cut.yy, varianceAlong(cut)) / (cell * cell);
    const vec3 to_cells =
        sqrt(vec3(sharpened(variance.x), sharpened(variance.y), sharpened(variance.z)) / variance) / cell;
    cut.xx *= to_cells.x * to_cells.x;
    cut.xy *= to_cells.x * to_cells.y;
    cut.yy *= to_cells.y * to_cells.y;
    cut.tilt_x *= to_cells.z / to_cells.x;
    cut.tilt_y *= to_cells.z / to_cells.y;
    cut.along *= to_cells.z * to_cells.z;
    const float before = acrossDeterminant(cut) / (to_cells.x * to_cells.x * to_cells.y * to_cells.y) /
                         (cell.x * cell.x * cell.y * cell.y); // as it was, cells^4
    cut = widenedAcross(cut, kLeastVariance);
    const float determinant = acrossDeterminant(cut), unit = 0.5 / determinant;
    light.at.w = 0.5 * column * sqrt(before / determinant);
    light.k.z = inversesqrt(2 * max(cut.along, 1e-3));
    deviations = sqrt(max(vec3(cut.xx, cut.yy, varianceAlong(cut)), variance));
    return Skew(unit * cut.yy, -unit * cut.xy, unit * cut.xx, vec2(cut.tilt_x, cut.tilt_y));
}

void main() {
    const uint i = gl_WorkGroupID.x * 32 + laneOfWord();
    ivec2 lines[3] = ivec2[](ivec2(1, 0), ivec2(1, 0), ivec2(1, 0)); // without groups: particles know them
    if (i < tick.particle_count) {
        const Particle p = particles[i];
        const float u = p.scale * tick.falloff;
        const float k = gaussianK(p.scale, tick.falloff);
        const vec3 cell = (tick.map.hi - tick.map.lo) / vec3(tick.map.texels, tick.map.slices - 1); // m
        const vec3 at = vec3(dot(tick.map.x, p.centre) - tick.map.lo.x, dot(tick.map.y, p.centre) - tick.map.lo.y,
                             tick.map.hi.z - dot(tick.sun.to_light, p.centre)) / cell - vec3(0.5, 0.5, 0);
        const vec3 variance = 0.5 / (k * cell * k * cell);
        vec3 stored = vec3(sharpened(variance.x), sharpened(variance.y), sharpened(variance.z));
        if (kFronts) stored = variance; // as printed: a texel's depth is that of the line through it
        const float column = lineDepth(p.sigma_t, k, 1.0) * sqrt(variance.x / stored.x * (variance.y / stored.y));
        LightParticle light = LightParticle(vec4(at, 0.5 * column), inversesqrt(2 * stored), 1);
        vec3 deviations = sqrt(variance); // along columns, rows and planes, cells
        if (kFronts) {
            // A step halfway before the plane behind the front, or before the second one.
            light.at.z = max(ceil(at.z - p.scale / cell.z), 1) - 0.5;
            light.k.z = kSharp;
            deviations.z = 0;
        }
        if (kEllipsoids) light_skews[i] = skewOf(axes[i], 0.1 * u, cell, p.sigma_t, light, deviations);

        // Sharpening makes a column depth up to 4/3 as large.
        const float radius = supportRadius(p.sigma_t, u, 0.75 * tick.cut);
        if (radius > 0) {
            const vec3 reach = radius / (0.1 * u) * deviations, size = vec3(kColumns, kRows, kGroup);
            const ivec3 last = ivec3(push.tiles) - 1;
            // Group g holds particles that add depth between planes kGroup g and kGroup (g + 1). One that ends between
            // two planes counts at the lower one.
            const vec3 middle = light.at.xyz;
            const ivec3 from = clamp(ivec3(floor((middle - reach - vec3(0, 0, 1)) / size)), ivec3(0), last);
            const ivec3 to = clamp(ivec3(floor((middle + reach) / size)), ivec3(0), last);
            lines[0] = ivec2(from.x, to.x);
            lines[1] = ivec2(from.y, to.y);
            light.reach = uint(from.z) | uint(to.z) << 16;
        }
        light_particles[i] = light;
    }
    writeBins(0, lines, uvec3(push.tiles.xy, 0));
}
