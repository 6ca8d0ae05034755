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

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 1) uniform EyeBlock { Eye eye; MapRays map_rays; };
layout(scalar, binding = 2) readonly buffer Particles { Particle particles[]; };
layout(scalar, binding = 3) readonly buffer Cells { Tetrahedron cells[]; };
layout(scalar, binding = 4) readonly buffer Faces { TetrahedraFace faces[]; };
layout(scalar, binding = 5) readonly buffer FaceNodes { ObjectNode face_nodes[]; };
layout(binding = 6) uniform sampler2DArray shadow_volume;
layout(binding = 7) uniform sampler2D opaque_shadow;
layout(binding = 8) uniform sampler2D view_depth;
layout(rgba32f, binding = 9) uniform image2D radiance;
layout(binding = 10) uniform sampler2DArray fluence;

layout(push_constant, scalar) uniform Push {
    vec3 albedo; // of all corners, with kOneAlbedo
    uint faces;  // of the outside
} push;

#include "shaders/lib/medium_phase.glsl"
#include "shaders/lib/eye.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/multiple.glsl"
#include "shaders/lib/tetrahedra.glsl"

const float kLeastSeen = 1e-5; // transmittance from which on nothing is seen

// What is seen of the medium from the ray's begin on.
struct Seen {
    float depth;    // optical depth
    vec3 scattered; // of the sun's light, without phase function and irradiance
    vec3 again;     // of light that has scattered before, without irradiance
    vec3 hidden;    // albedo times opacity
};

// Adds the part of a tetrahedron between two places on the ray. map_at: the line's origin in the shadow map.
void addInterval(inout Seen seen, Line line, vec3 map_at, vec3 map_per_m, float t0, float t1, vec2 sigma,
                 vec3 albedo[2]) {
    const float length = t1 - t0, depth = tick.extinction * linearDepth(sigma.x, sigma.y, length);
    if (!(depth > 0)) return;
    const float weight = opacity(depth) * exp(-seen.depth);
    float visible = 0; // part of the sun that objects let through
    [[unroll]] for (int i = 0; i < kNodes; ++i) {
        const float part = linearQuantile(sigma.x, sigma.y, depthPart(depth, legendreNode(i, kNodes)));
        const float t = t0 + length * part;
        const float past_objects = kHasCasters ? visibility(toLightSpace(line.origin + t * line.dir)) : 1;
        const float light = past_objects * exp(-lightDepth(map_at + t * map_per_m));
        const float own = weight * legendreWeight(i, kNodes);
        visible += legendreWeight(i, kNodes) * past_objects;
        const vec3 there = kOneAlbedo ? vec3(own) : own * mix(albedo[0], albedo[1], part);
        seen.scattered += light * there;
        if (kHasAmbient) seen.hidden += there;
    }
    if (kScatteringModel != kScatteringSingle) {
        vec3 straight;
        const vec3 light = multipleOfSlab(3, map_at + 0.5 * (t0 + t1) * map_per_m, depth,
                                          lightDepth(map_at + t0 * map_per_m),
                                          lightDepth(map_at + t1 * map_per_m), straight);
        const vec3 mean = kOneAlbedo ? vec3(1) : 0.5 * (albedo[0] + albedo[1]);
        seen.scattered += exp(-seen.depth) * visible * mean * straight;
        // Octaves come straight from the sun; what has passed through cells comes from all around.
        const float arrives = kScatteringModel == kScatteringOctaves ? visible : 1;
        seen.again += exp(-seen.depth) * arrives * mean * light;
    }
    seen.depth += depth;
}

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
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
    const vec3 map_at = map_rays.eye + next * map_per_m;

    startMultiple(line.dir);
    Seen seen = Seen(0, vec3(0), vec3(0), vec3(0));
    Walk walk;
    const vec3 from = line.origin + begin * line.dir;
    Entry entered = Entry(-kEndless, 0);
    bool inside = false;
    // Within the mesh's box the ray may begin in a tetrahedron: the walk then begins where the line came in behind it.
    if (all(greaterThanEqual(from, root.lo)) && all(lessThanEqual(from, root.hi)))
        inside = enterMesh(walk, line, push.faces, entered, begin, true);
    if (!inside) {
        entered = Entry(begin, 0);
        inside = enterMesh(walk, line, push.faces, entered, end, false);
    }
    [[dont_unroll]] while (inside) {
        [[dont_unroll]] for (uint n = 0; walk.cell != kNoTetrahedron && walk.t < end && n < cells.length(); ++n) {
            const bool placed = walk.placed;
            const float t = walk.t, sigma = walk.sigma;
            vec3 albedo[2] = vec3[](walk.albedo, vec3(1));
            passTetrahedron(walk, line);
            albedo[1] = walk.albedo;
            const float t0 = max(t, begin), t1 = min(walk.t, end);
            if (!placed || !(t1 > t0)) continue;
            const vec2 part = clamp((vec2(t0, t1) - t) / (walk.t - t), 0, 1);
            const vec3 begins = mix(albedo[0], albedo[1], part.x);
            albedo[1] = mix(albedo[0], albedo[1], part.y);
            albedo[0] = begins;
            addInterval(seen, line, map_at, map_per_m, t0, t1, mix(vec2(sigma), vec2(walk.sigma), part), albedo);
            if (exp(-seen.depth) < kLeastSeen) break;
        }
        if (exp(-seen.depth) < kLeastSeen || walk.t >= end) break;
        inside = enterAgain(walk, line, push.faces, entered, end);
    }
    if (!(seen.depth > 0)) return;
    float phase = 0.07957747154594767;
    if (kHasLobe) phase = mediumPhase(-tick.sun.to_light, -line.dir);
    vec3 medium = tick.sun.irradiance * phase * seen.scattered;
    if (kScatteringModel != kScatteringSingle) medium += tick.sun.irradiance * seen.again;
    if (kHasAmbient) medium += tick.ambient * seen.hidden;
    if (kOneAlbedo) medium *= push.albedo;
    imageStore(radiance, pixel, vec4(medium, 0) + exp(-seen.depth) * imageLoad(radiance, pixel));
}
