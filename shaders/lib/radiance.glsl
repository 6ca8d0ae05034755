// Light at a place as method `gradients` interpolates it: of points and spots fluence, or the part of it that arrives;
// of the sun the part that arrives. Include after `LightSampling push`, and what lit_grid.comp declares for the
// medium's nodes.
#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/grid_marks.glsl"
#include "shaders/lib/extinction_nodes.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/local_lights.glsl"
#include "shaders/lib/local_light_depth.glsl"
#include "shaders/lib/occluded.glsl"
#include "shaders/lib/near_lights.glsl"
#include "shaders/lib/sun_at_node.glsl"

const uint kMostSteps = 1024;    // of a march
// Least weights of a light where no other one shines. kNearWeight is of a light that is too near: it shines on places
// between the nodes. kAsideWeight is of a light whose cone or range leaves the place out.
const float kNearWeight = 1e-3, kAsideWeight = 1e-9;

bool isHow(uint bit) { return (push.how & bit) != 0; }

// Optical depth of the particles on a way of unit direction, by samples in the middle of its steps.
float marchedDepth(vec3 x, vec3 dir, float distance) {
    const vec3 size = vec3(push.medium.bricks * kSlabTile), inverse = inverseOf(dir);
    const vec3 a = (push.medium.origin - x) * inverse,
               b = (push.medium.origin + push.medium.spacing * size - x) * inverse;
    const vec3 enters = min(a, b), leaves = max(a, b);
    const float begin = max(max(enters.x, enters.y), max(enters.z, 0)),
                end = min(min(leaves.x, leaves.y), min(leaves.z, distance));
    if (!(begin < end)) return 0;
    const float step = push.step > 0 ? push.step : push.medium.spacing;
    const uint steps = clamp(uint(ceil((end - begin) / step)), 1u, kMostSteps);
    const float width = (end - begin) / float(steps);
    float sum = 0;
    [[dont_unroll]] for (uint i = 0; i < steps; ++i) sum += extinctionAt(x + (begin + (float(i) + 0.5) * width) * dir);
    return width * sum;
}

// The same between a local light and a place.
float particleDepth(LocalLight light, vec3 away, float distance) {
    if (light.shadows == 0 || tick.particle_count == 0) return 0;
    if (push.step > 0) return marchedDepth(light.position, away / max(distance, 1e-20), distance);
    return particlesFromBeside(light, away, distance);
}

// The part of a light that arrives at a place, past objects and through the medium.
float arrivingPart(LocalLight light, vec3 x, vec3 away, float distance) {
    if (light.shadows != 0 && kHasOpaque && isOccluded(x, -away, true)) return 0;
    return exp(-(kHasFog ? fogFrom(light, away, distance) : 0) - particleDepth(light, away, distance));
}

// Fluence of a light at a distance, W/m^2, without cone, range and what is in its way. Nodes keep a part of it.
vec3 fallenOff(LocalLight light, float distance) {
    return light.intensity * (keptPart(distance) / max(distance * distance + light.radius * light.radius, 1e-12));
}

uint places_lit = 0; // by this lane

vec4 lightAt(vec3 x) {
    ++places_lit;
    vec3 arrives = vec3(0), all = vec3(0);
    const uint lights = kHasLocalLights ? tick.local_light_count : 0;
    [[dont_unroll]] for (uint i = 0; i < lights; ++i) {
        const LocalLight light = local_lights[i];
        const vec3 away = x - light.position;
        const float distance = length(away), sent = sentTo(light, away, distance);
        if (!(sent > 0)) continue;
        const vec3 kept = sent * fallenOff(light, distance);
        if (!(max(max(kept.r, kept.g), kept.b) > 0)) continue;
        all += kept;
        arrives += kept * arrivingPart(light, x, away, distance);
    }
    const float sun = tick.sun.irradiance != vec3(0) ? sunAt(x) : 0;
    if (isHow(kRadiance)) return vec4(arrives, sun);
    // Where nothing is sent in a colour, places nearby that are lit ask how much would arrive.
    const bvec3 dark = equal(all, vec3(0));
    if (lights > 0 && any(dark)) {
        const vec3 missing = vec3(dark);
        [[dont_unroll]] for (uint i = 0; i < lights; ++i) {
            const LocalLight light = local_lights[i];
            const vec3 away = x - light.position;
            const float distance = length(away);
            const float falls = 1 / max(distance * distance + light.radius * light.radius, 1e-12);
            const vec3 aside = missing * light.intensity *
                               (max(keptPart(distance), kNearWeight) *
                                max(sentTo(light, away, distance), kAsideWeight) * falls);
            if (!(max(max(aside.r, aside.g), aside.b) > 0)) continue;
            all += aside;
            arrives += aside * arrivingPart(light, x, away, distance);
        }
    }
    return vec4(arrives / max(all, vec3(1e-30)), sun);
}

// All light of points and spots that nodes keep there if nothing is in its way: fluence of each colour.
vec3 lightSent(vec3 x) {
    vec3 all = vec3(0);
    [[dont_unroll]] for (uint i = 0; i < (kHasLocalLights ? tick.local_light_count : 0); ++i) {
        const LocalLight light = local_lights[i];
        const vec3 away = x - light.position;
        const float distance = length(away), sent = sentTo(light, away, distance);
        if (!(sent > 0)) continue;
        all += sent * fallenOff(light, distance);
    }
    return all;
}

// 1/m, of all media. `around`: m, half the length over which fog is taken.
float mediaAt(vec3 x, float around) {
    const float particles = tick.particle_count > 0 ? extinctionAt(x) : 0;
    if (!kHasFog) return particles;
    return particles + fogBetween(x - vec3(around, 0, 0), vec3(1, 0, 0), 1, 0, 2 * around) / (2 * around);
}

float longestSide() { // m, of the box of the nodes
    const uvec3 nodes = push.lit.bricks * kSlabTile;
    return push.lit.spacing * float(max(max(nodes.x, nodes.y), nodes.z));
}

// The optical depth, and the opacity, that the medium at x would have all through that box.
float depthAround(vec3 x) { return mediaAt(x, 0.5 * push.lit.spacing) * longestSide(); }
float opacityAround(vec3 x) { return opacity(depthAround(x)); }

// What an error of light at x is worth: of its fluence as a part of push.scale, times the opacity, or as printed times
// the density.
float worthOf(vec4 off, vec3 x) {
    const float depth = depthAround(x), medium = isHow(kShadingError) ? depth : opacity(depth);
    if (!(medium > 0)) return 0;
    const vec3 luminance = vec3(0.2126, 0.7152, 0.0722);
    const vec3 sent = isHow(kRadiance) ? vec3(1) : lightSent(x);
    const float local = dot(abs(off.rgb) * sent, luminance), sun = abs(off.w) * dot(tick.sun.irradiance, luminance);
    return medium * (local + sun) / push.scale;
}
