#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `tetrahedra`, per eye: the medium before each pixel's surface, over what is drawn there. A lane is a pixel.
// Its ray walks from tetrahedron to tetrahedron. In each the extinction is linear, and light is looked up where parts
// of what reaches the eye are scattered.
#include "shaders/shared/constants.h"
#include "shaders/shared/scatter.h"
#include "shaders/shared/tetrahedra.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdHasLobe) const bool kHasLobe = true;
layout(constant_id = kIdHasAmbient) const bool kHasAmbient = true;
layout(constant_id = kIdOneAlbedo) const bool kOneAlbedo = false;
layout(constant_id = kIdSteps) const int kNodes = 2;
layout(constant_id = kIdScattering) const uint kScatteringModel = 0;

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(scalar) readonly buffer Cells { Tetrahedron cells[]; };
layout(scalar) readonly buffer Faces { TetrahedraFace faces[]; };
layout(scalar) readonly buffer FaceNodes { ObjectNode face_nodes[]; };
layout(rgba32f) uniform image2D radiance;

layout(push_constant, scalar) uniform Push {
    vec3 albedo;  // of all corners, with kOneAlbedo
    uint faces;   // of the outside
    float agrees; // lib/tetrahedra_light.glsl
} push;

#include "shaders/lib/medium_phase.glsl"
#include "shaders/lib/even_light.glsl"
#include "shaders/lib/eye.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/multiple.glsl"
#include "shaders/lib/tetrahedra.glsl"
#include "shaders/lib/tetrahedra_light.glsl"
#include "shaders/lib/spread.glsl"

const float kLeastSeen = 1e-5; // transmittance from which on nothing is seen
// A part of a tetrahedron in which light is looked up kNodes times: its optical depth, and its length over the diagonal
// of the medium's bounds. Shadows of objects may be narrow.
const float kPartDepth = 0.3;
const float kPartLength = kHasCasters ? 0.0125 : 0.05;

// What is seen of the medium from the ray's begin on.
struct Seen {
    float depth;    // optical depth
    vec3 scattered; // of the sun's light, without phase function and irradiance
    vec3 again;     // of light that has scattered before, without irradiance
    vec3 hidden;    // albedo times opacity
};

// A part of a line within a tetrahedron: both ends.
struct Part {
    vec2 t;     // m
    vec2 sigma; // 1/m
    vec3 albedo[2];
};

Part partOf(Part whole, vec2 at) {
    Part part;
    part.t = mix(whole.t.xx, whole.t.yy, at);
    part.sigma = mix(whole.sigma.xx, whole.sigma.yy, at);
    part.albedo[0] = mix(whole.albedo[0], whole.albedo[1], at.x);
    part.albedo[1] = mix(whole.albedo[0], whole.albedo[1], at.y);
    return part;
}

// A line's places in the shadow map: at + t * per_m.
struct MapLine {
    vec3 at, per_m;
};

float lightDepthOn(Line line, MapLine map, uint cell, float t, float sigma) {
    return lightDepthWithin(cell, line.origin + t * line.dir, map.at + t * map.per_m, sigma);
}
float visibilityOn(Line line, float t) { return visibility(toLightSpace(line.origin + t * line.dir)); }

// Adds a part in which light is smooth.
void addSmooth(inout Seen seen, Line line, MapLine map, uint cell, Part part) {
    const float length = part.t.y - part.t.x;
    const float depth = tick.extinction * linearDepth(part.sigma.x, part.sigma.y, length);
    if (!(depth > 0)) return;
    const float weight = opacity(depth) * exp(-seen.depth);
    float visible = 0;        // part of the sun that objects let through
    vec2 ends_at, ends_depth; // the first and the last place: part of the length, light depth
    [[unroll]] for (int i = 0; i < kNodes; ++i) {
        const float at = linearQuantile(part.sigma.x, part.sigma.y, depthPart(depth, legendreNode(i, kNodes)));
        const float t = part.t.x + length * at;
        const float past_objects = kHasCasters ? visibilityOn(line, t) : 1;
        const float light_depth = lightDepthOn(line, map, cell, t, mix(part.sigma.x, part.sigma.y, at));
        const float light = past_objects * exp(-light_depth);
        if (i == 0) ends_at.x = at, ends_depth.x = light_depth;
        if (i == kNodes - 1) ends_at.y = at, ends_depth.y = light_depth;
        const float own = weight * legendreWeight(i, kNodes);
        visible += legendreWeight(i, kNodes) * past_objects;
        const vec3 there = kOneAlbedo ? vec3(own) : own * mix(part.albedo[0], part.albedo[1], at);
        seen.scattered += light * there;
        if (kHasAmbient || kHasEmission) seen.hidden += there;
    }
    if (kScatteringModel != kScatteringSingle) {
        const float slope = (ends_depth.y - ends_depth.x) / max(ends_at.y - ends_at.x, 1e-6); // 0 with one place
        vec3 straight;
        const vec3 light = multipleOfSlab(3, map.at + 0.5 * (part.t.x + part.t.y) * map.per_m, depth,
                                          max(ends_depth.x - slope * ends_at.x, 0),
                                          max(ends_depth.y + slope * (1 - ends_at.y), 0), straight);
        const vec3 mean = kOneAlbedo ? vec3(1) : 0.5 * (part.albedo[0] + part.albedo[1]);
        seen.scattered += exp(-seen.depth) * visible * mean * straight;
        // Octaves come straight from the sun; what has passed through cells comes from all around.
        const float arrives = kScatteringModel == kScatteringOctaves ? visible : 1;
        seen.again += exp(-seen.depth) * arrives * mean * light;
    }
    seen.depth += depth;
}

// Where the shadow of an object begins or ends on a line, between two places of different visibility.
float shadowEdge(Line line, vec2 t, float visible) {
    [[dont_unroll]] for (int i = 0; i < 8; ++i) {
        const float middle = 0.5 * (t.x + t.y);
        if (visibilityOn(line, middle) == visible)
            t.x = middle;
        else
            t.y = middle;
    }
    return 0.5 * (t.x + t.y);
}

// Adds all that a line has of a tetrahedron, in parts whose light is smooth.
void addInterval(inout Seen seen, Line line, MapLine map, uint cell, Part whole) {
    const float length = whole.t.y - whole.t.x;
    const float depth = tick.extinction * linearDepth(whole.sigma.x, whole.sigma.y, length);
    if (!(depth > 0)) return;
    const float shown = min(depth, kDark); // a depth of kDark hides what is behind it
    const float parts = ceil(max(shown / kPartDepth, length / (kPartLength * distance(tick.map.lo, tick.map.hi))));
    const float before = seen.depth;
    vec2 at = vec2(0);
    [[dont_unroll]] for (float p = 1; p <= parts; ++p) {
        const bool last = p == parts && shown == depth;
        at = vec2(at.y, last ? 1 : linearQuantile(whole.sigma.x, whole.sigma.y, p * shown / (parts * depth)));
        vec2 cut = at.yy;
        if (kHasCasters) {
            const vec2 ends = whole.t.x + length * at;
            const float visible = visibilityOn(line, ends.x);
            if (visible != visibilityOn(line, ends.y))
                cut.x = clamp((shadowEdge(line, ends, visible) - whole.t.x) / length, at.x, at.y);
        }
        addSmooth(seen, line, map, cell, partOf(whole, vec2(at.x, cut.x)));
        if (kHasCasters && cut.x < cut.y) addSmooth(seen, line, map, cell, partOf(whole, cut));
        if (exp(-seen.depth) < kLeastSeen) break;
    }
    seen.depth = before + depth;
}

void main() {
    const ivec2 pixel = ivec2(spreadInvocation().xy);
    if (any(greaterThanEqual(pixel, ivec2(eye.size)))) return;
    const float surface = kHasOpaque ? texelFetch(view_depth, pixel, 0).r : kEndless;
    if (surface == 0) return; // the pixel is finished (drawn_cells.comp)
    const vec2 place = vec2(pixel) + 0.5;
    const vec3 dir = rayDirection(place);
    const float inverse_length = inversesqrt(dot(dir, dir)), per_depth = dot(dir, dir) * inverse_length;
    const vec3 map_per_m = inverse_length * (map_rays.ray + place.x * map_rays.right + place.y * map_rays.down);
    // From the place next to the mesh's middle: so the corners are rounded as small numbers, wherever the eye is.
    const ObjectNode root = face_nodes[0];
    const vec3 unit = dir * inverse_length;
    const float next = dot(0.5 * (root.lo + root.hi) - eye.position, unit);
    const Line line = lineOf(eye.position + next * unit, unit);
    const float begin = eye.near_depth * per_depth - next, end = min(surface * per_depth - next, kEndless);
    const MapLine map = MapLine(map_rays.eye + next * map_per_m, map_per_m);

    startMultiple(line.dir);
    Seen seen = Seen(0, vec3(0), vec3(0), vec3(0));
    Walk walk;
    const vec3 from = line.origin + begin * line.dir;
    Entry entered = Entry(-kEndless, 0);
    bool inside = false;
    // Within the mesh's box the ray may begin in a tetrahedron: the walk then begins where the line came in behind it.
    if (all(greaterThanEqual(from, root.lo)) && all(lessThanEqual(from, root.hi)))
        inside = enterMesh(walk, line, push.faces, entered, begin, true);
    // Pieces that touch there begin within roundings of each other: the line may be in any of them.
    entered.t -= inside ? roundingAt(line, entered.t) : 0;
    if (!inside) {
        entered = Entry(begin, 0);
        inside = enterMesh(walk, line, push.faces, entered, end, false);
    }
    [[dont_unroll]] while (inside) {
        [[dont_unroll]] for (uint n = 0; walk.cell != kNoTetrahedron && walk.t < end && n < cells.length(); ++n) {
            const bool placed = walk.placed;
            const uint cell = walk.cell;
            const float t = walk.t;
            Part part = Part(vec2(t), vec2(walk.sigma), vec3[](walk.albedo, walk.albedo));
            passTetrahedron(walk, line);
            part.t.y = walk.t, part.sigma.y = walk.sigma, part.albedo[1] = walk.albedo;
            const vec2 ends = vec2(max(t, begin), min(walk.t, end));
            if (!placed || !(ends.y > ends.x)) continue;
            part = partOf(part, clamp((ends - t) / (walk.t - t), 0, 1));
            addInterval(seen, line, map, cell, part);
            if (exp(-seen.depth) < kLeastSeen) break;
        }
        if (exp(-seen.depth) < kLeastSeen || walk.t >= end) break;
        inside = enterAgain(walk, line, push.faces, entered, end);
    }
    if (!(seen.depth > 0)) return;
    float phase = 0.07957747154594767;
    if (kHasLobe) phase = mediumPhase(-tick.sun.to_light, -line.dir);
    vec3 medium = tick.sun.irradiance * phase * seen.scattered;
    if (kScatteringModel != kScatteringSingle) medium += tick.multiple.irradiance * seen.again;
    if (kOneAlbedo) medium *= push.albedo, seen.hidden *= push.albedo;
    medium += evenLight(opacity(seen.depth), seen.hidden);
    imageStore(radiance, pixel, vec4(medium, 0) + exp(-seen.depth) * imageLoad(radiance, pixel));
}
