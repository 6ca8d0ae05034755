#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `grid`, last pass, per eye: traces rays through the nodes.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 64) in; // kSlabTile * kSlabTile

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdSunColours) const uint kSunColours = 1;
layout(constant_id = kIdAmbientColours) const uint kAmbientColours = 0;
layout(constant_id = kIdMultipleColours) const uint kMultipleColours = 0;
layout(constant_id = kIdScattering) const uint kScatteringModel = 0;
layout(constant_id = kIdHasLobe) const bool kHasLobe = true;
layout(constant_id = kIdCubic) const bool kCubic = true;

layout(scalar) readonly buffer Nodes { float nodes[]; }; // written by grid_fill.comp
layout(scalar) buffer Field { float field[]; };          // shared/field.h
layout(scalar) readonly buffer Marks { uint marks[]; };  // lib/grid_marks.glsl

layout(push_constant, scalar) uniform Push { MediumGrid medium; } push;

#include "shaders/lib/grid_marks.glsl"

vec3 eye_at, ray_dir; // in nodes

#include "shaders/lib/field_planes.glsl"
#include "shaders/lib/spline.glsl"
#include "shaders/lib/whole.glsl"

// Samples are taken where all nodes that they need are in the grid: between these, in nodes.
const vec3 kFirst = vec3(1);
vec3 beyondLast() { return vec3(push.medium.bricks * kSlabTile - 2); }

uvec2 startRay(uvec3 tile, uint ray, vec2 pixel) {
    eye_at = (eye.position - push.medium.origin) / push.medium.spacing;
    ray_dir = (eye.ray + pixel.x * eye.ray_right + pixel.y * eye.ray_down) / push.medium.spacing;
    const vec3 inverse = 1 / mix(ray_dir, vec3(1e-12), lessThan(abs(ray_dir), vec3(1e-12)));
    const vec3 a = (kFirst - eye_at) * inverse, b = (beyondLast() - eye_at) * inverse;
    const vec3 enter = min(a, b), leave = max(a, b);
    const vec2 faces = slabsAt(vec2(max(enter.x, max(enter.y, enter.z)), min(leave.x, min(leave.y, leave.z))));
    if (faces.x > faces.y) return uvec2(grid.slabs);
    // One more slab for the parabola through three middles, and one for rounding.
    return uvec2(clamp(vec2(floor(faces.x) - 2, ceil(faces.y) + 2), 0, float(grid.slabs)));
}

// A quantity at position `t` (0 ... 1) in the cell whose nodes begin at `first`.
float linear(uint first, uint row, uint sheet, vec3 t) {
    const vec4 below = vec4(nodes[first], nodes[first + 1], nodes[first + row], nodes[first + row + 1]);
    const vec4 above = vec4(nodes[first + sheet], nodes[first + sheet + 1], nodes[first + sheet + row],
                            nodes[first + sheet + row + 1]);
    const vec4 here = mix(below, above, t.z);
    return mix(mix(here.x, here.y, t.x), mix(here.z, here.w, t.x), t.y);
}
float cubic(uint first, uint row, uint sheet, vec3 t) {
    const vec4 x = spline(t.x), y = spline(t.y), z = spline(t.z);
    float sum = 0;
    [[unroll]] for (uint k = 0; k < 4; ++k)
        [[unroll]] for (uint j = 0; j < 4; ++j) {
            const uint n = first + k * sheet + j * row - (sheet + row + 1);
            sum += z[k] * y[j] * dot(x, vec4(nodes[n], nodes[n + 1], nodes[n + 2], nodes[n + 3]));
        }
    return sum;
}

vec4 mediumAt(uint s) {
    const vec3 at = eye_at + middleDepth(s) * ray_dir;
    const uvec3 size = push.medium.bricks * kSlabTile;
    vec4 medium = vec4(0);
    if (all(greaterThanEqual(at, kFirst)) && all(lessThan(at, beyondLast()))) {
        const uvec3 cell = nearestWhole(floor(at)), brick = cell / kSlabTile;
        if ((marks[markWord(kSampled, brick)] >> (brick.x % 32) & 1) != 0) {
            const vec3 t = fract(at);
            const uint row = size.x, sheet = size.y * row, first = cell.z * sheet + cell.y * row + cell.x;
            for (uint q = 0; q < mediumQuantities(kSunColours == 1); ++q) {
                const uint from = first + q * size.z * sheet;
                medium[q] = kCubic ? cubic(from, row, sheet, t) : linear(from, row, sheet, t);
            }
        }
    }
    return medium;
}

#include "shaders/lib/slab_march.glsl"

void main() { march(); }
