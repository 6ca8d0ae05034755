#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Six fluxes: the sun's light that planes, boxes and spheres reflect once, by Lambert's law, into the cells of the
// second grid. Each surface is divided into parts of known solid angle. A lane is a cell.
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/surface_light.h"

layout(local_size_x = 64) in;

layout(constant_id = kIdHasCasters) const bool kHasCasters = true;

#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Cells { float cells[]; };
layout(scalar) readonly buffer Reflecting { uint reflecting[]; }; // indices of boxes and spheres

#include "shaders/lib/flux_grid.glsl"
layout(scalar) writeonly buffer Surfaces { SurfaceLight surfaces[]; }; // [channel][cell]

#include "shaders/lib/fog.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/mesh_heights.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/object_tree.glsl"
#include "shaders/lib/behind_bodies.glsl"

const float kPi = 3.14159265;
const float kDeepest = 80; // optical depth, of which more counts as this
const uint kSteps = 8;     // places along a ray where the extinction is looked up

// A part of a surface, from the middle of a cell.
struct Part {
    vec3 toward; // unit
    float distance;
    vec3 normal;
    float solid_angle;
};

vec3 x;        // middle of the cell, m
vec3 in_grid;  // the cell's middle, in cells from the grid's corner
vec4 sums[3];  // net flux and fluence in each channel
float free[3]; // fluence in each channel if no medium dimmed it

// A direction along the axes of the fluxes.
vec3 alongFluxes(vec3 v) { return vec3(dot(tick.map.x, v), dot(tick.map.y, v), -dot(tick.sun.to_light, v)); }

float extinctionIn(ivec3 place) {
    const uvec3 inside = uvec3(clamp(place, ivec3(0), ivec3(push.side) - 1));
    return cells[numbersAt(push.first + cellAt(inside, push.side))];
}

// Optical depth, not scaled, between the cell's middle and what is `distance` away.
float depthToward(vec3 toward, float distance) {
    const vec3 per_metre = alongFluxes(toward) / cellSize(), speed = max(abs(per_metre), vec3(1e-20));
    const vec3 room = mix(in_grid, float(push.side) - in_grid, greaterThan(per_metre, vec3(0))) / speed;
    const float step = min(distance, min(room.x, min(room.y, room.z))) / float(kSteps);
    float depth = 0;
    for (uint i = 0; i < kSteps; ++i)
        depth += extinctionIn(ivec3(floor(in_grid + (float(i) + 0.5) * step * per_metre)));
    return step * depth;
}

// The sun's irradiance of a surface, for E = 1.
float sunlit(vec3 at, vec3 normal, float cosine) {
    float lit = cosine * exp(-lightDepthAnywhere(toShadowVolume(at)));
    if (kHasCasters) { // as in lib/background.glsl
        const float texel = (tick.map.opaque_hi.x - tick.map.opaque_lo.x) / float(tick.map.opaque_size);
        const float slope = texel * 2 * sqrt(max(1 - cosine * cosine, 0)) / max(cosine, 0.1);
        const vec3 beside = toLightSpace(at + normal * 2 * texel);
        lit *= visibilityFiltered(beside, slope);
        if (kHasMeshes) lit *= visibilityPastMeshes(beside);
    }
    if (kHasFog) lit *= exp(-fogTowardSun(at));
    return lit;
}

void add(vec3 albedo, Part part) {
    const float cosine = dot(part.normal, tick.sun.to_light);
    if (!(cosine > 0) || !(part.solid_angle > 0) || isBehindBody(x, 0.999 * part.distance * part.toward, false)) return;
    float light = sunlit(x + part.distance * part.toward, part.normal, cosine) / kPi * part.solid_angle;
    if (kHasFog) light *= exp(-fogBetween(x, part.toward, 1, 0, part.distance));
    if (!(light > 0)) return;
    const float depth = depthToward(part.toward, part.distance);
    const vec3 flux = -alongFluxes(part.toward);
    for (uint c = 0; c < push.channels; ++c) {
        const float own = light * (push.channels == 1 ? dot(albedo, vec3(1 / 3.0)) : albedo[c]);
        free[c] += own;
        sums[c] += own * exp(-tick.multiple.passed[c] * depth) * vec4(flux, 1);
    }
}

float partsOf() { return float(push.parts * push.parts); } // how many parts a plane, a sphere or a face has

// A plane fills the lower half of all directions.
Part partOfPlane(Opaque plane, uint i) {
    const vec3 down = coneDirection(int(i), int(push.parts), 1);
    return Part(vec3(down.x, -down.z, down.y), (x.y - plane.centre.y) / down.z, vec3(0, 1, 0), 2 * kPi / partsOf());
}

Part partOfSphere(Opaque sphere, uint i) {
    const vec3 off = sphere.centre - x;
    const float distance = length(off), radius = sphere.half_size.x;
    const vec3 axis = off / distance;
    const vec3 side = normalize(cross(axis, abs(axis.y) < 0.7 ? vec3(0, 1, 0) : vec3(1, 0, 0)));
    const float edge = sphereEdge(radius / distance);
    const vec3 local = coneDirection(int(i), int(push.parts), edge);
    const vec3 toward = local.x * side + local.y * cross(side, axis) + local.z * axis;
    const float along = dot(off, toward);
    const vec3 beside = off - along * toward;
    const float to = along - sqrt(max(radius * radius - dot(beside, beside), 0));
    return Part(toward, to, (to * toward - off) / radius, 2 * kPi * edge / partsOf());
}

// Boundaries of a face's parts along its two sides, from the foot of the cell on it.
vec2 evenAngles(vec2 i, vec2 half_face, vec2 foot, float height) {
    const float parts = float(push.parts);
    return vec2(evenAngle(i.x, parts, -half_face.x - foot.x, half_face.x - foot.x, height),
                evenAngle(i.y, parts, -half_face.y - foot.y, half_face.y - foot.y, height));
}

// A rectangle of the face across an axis, if the cell sees it.
Part partOfBox(Opaque box, uint axis, uint i) {
    const vec3 from = toObject(box, x - box.centre), half_size = box.half_size;
    const float height = abs(from[axis]) - half_size[axis];
    if (!(height > 0)) return Part(vec3(0), 0, vec3(0), 0);
    vec3 local = vec3(0);
    local[axis] = from[axis] < 0 ? -1 : 1;
    const vec3 normal = fromObject(box, local);
    const uint u = (axis + 1) % 3, v = (axis + 2) % 3;
    const vec2 half_face = vec2(half_size[u], half_size[v]), foot = vec2(from[u], from[v]);
    const vec2 begin = vec2(i % push.parts, i / push.parts);
    const vec2 lo = evenAngles(begin, half_face, foot, height), hi = evenAngles(begin + 1, half_face, foot, height);
    const vec2 middle = evenAngles(begin + 0.5, half_face, foot, height);
    local[axis] *= -height;
    local[u] = middle.x;
    local[v] = middle.y;
    const float distance = length(local);
    return Part(fromObject(box, local) / distance, distance, normal,
                rectangleSolidAngle(lo.x, lo.y, hi.x, hi.y, height));
}

void main() {
    if (gl_GlobalInvocationID.x >= push.side * push.side * push.side) return;
    const uvec3 place = placeOf(gl_GlobalInvocationID.x);
    in_grid = vec3(place) + 0.5;
    const vec3 middle = in_grid / float(push.side);
    x = fromLightSpace(mix(tick.map.lo, tick.map.hi, vec3(middle.xy, 1 - middle.z)));
    for (uint c = 0; c < 3; ++c) sums[c] = vec4(0), free[c] = 0;

    uint highest = 0; // index of the highest plane
    for (uint i = 1; i < tick.plane_count; ++i)
        if (objects[i].centre.y > objects[highest].centre.y) highest = i;
    // True: the cell's middle lies within an object or below the ground.
    const bool solid = (tick.plane_count > 0 && x.y <= objects[highest].centre.y) || isInSolid(x);
    const uint parts = push.parts * push.parts;
    // First the plane, then the others.
    [[dont_unroll]] for (uint n = tick.plane_count > 0 ? 0 : 1; n <= push.surfaces && !solid; ++n) {
        const Opaque o = objects[n == 0 ? highest : reflecting[n - 1]];
        [[dont_unroll]] for (uint i = 0; i < (o.kind == kBox ? 3 * parts : parts); ++i) {
            Part part;
            if (o.kind == kPlane) part = partOfPlane(o, i);
            else if (o.kind == kSphere) part = partOfSphere(o, i);
            else part = partOfBox(o, i / parts, i % parts);
            add(o.albedo, part);
        }
    }
    const uint count = push.side * push.side * push.side;
    for (uint c = 0; c < push.channels; ++c) {
        SurfaceLight light = SurfaceLight(solid ? -1 : tick.multiple.sun[c] * free[c], kDeepest, vec3(0));
        if (sums[c].w > 1e-30) { // a smaller fluence may count as 0 in a division
            light.depth = min(log(free[c] / sums[c].w), kDeepest);
            light.mean_way = sums[c].xyz / sums[c].w;
        }
        surfaces[c * count + cellAt(place, push.side)] = light;
    }
}
