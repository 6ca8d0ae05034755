// Light in a slice of a ray: what its media scatter of the sun and of points and spots, at the middle of the slice.
// Include after lib/march_ray.glsl, `bool hasParticles()`, lib/medium_nodes.glsl, lib/light.glsl,
// lib/local_lights.glsl, lib/local_light_depth.glsl and lib/occluded.glsl.
#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/equiangular.h"
#include "shaders/shared/phase.h"

const float kFarAway = 1e6; // m, where the sun's rays are taken to begin

float phaseAt(Phase p, vec3 travel) {
    return phaseOfLobes(travel, -ray_unit, p.part, p.asymmetry, p.draine, p.second);
}

// What the medium of a slice scatters: the parts of its optical depth, times albedo.
vec3 of_particles;       // of the particles
vec3 of_fogs[kMostFogs]; // of each fog

// Light of one direction: what reaches the eye of an irradiance of 1.
vec3 scatteredFrom(vec3 travel) {
    vec3 sum = of_particles * phaseAt(tick.phase, travel);
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i) sum += of_fogs[i] * phaseAt(tick.fogs[i].phase, travel);
    return sum;
}

// The part of a local light that objects let through to x, which lies `away` from it.
float litPart(uint i, vec3 x, vec3 away);

// The part of a local light that arrives at x, past objects and through the medium.
float arrivingPart(uint i, vec3 x, vec3 away, float distance) {
    const LocalLight light = local_lights[i];
    const float part = light.shadows != 0 && kHasOpaque ? litPart(i, x, away) : 1;
    if (!(part > 0)) return 0;
    return part * exp(-(kHasFog ? fogFrom(light, away, distance) : 0) - particlesFrom(light, away, distance));
}

// The part of it that is added.
vec3 addedPart(uint i, vec3 x, vec3 away, float distance);

// What a point or a spot adds in the slice, if all is as at `place`. falls: its inverse square, 1/m^2.
vec3 ofLightAt(uint i, vec3 place, float falls) {
    const LocalLight light = local_lights[i];
    const vec3 away = place - light.position;
    const float distance = length(away), sent = sentTo(light, away, distance);
    if (!(sent > 0)) return vec3(0);
    const vec3 part = addedPart(i, place, away, distance);
    if (part == vec3(0)) return vec3(0);
    return light.intensity * part * (sent * falls) * scatteredFrom(away / max(distance, 1e-20));
}

// The same with the mean of the inverse square over the slice. All else is looked up where half of the light comes from
// (shared/equiangular.h), or the part `angle_part` of it: one sample in the middle is 3.6 times too bright a tenth of a
// slice beside a light.
vec3 ofLocalLight(uint i, float near, float far) {
    const LocalLight light = local_lights[i];
    const float closest = dot(light.position - eye.position, ray_unit);
    const vec3 foot = eye.position + closest * ray_unit, off = foot - light.position;
    const EquiangularPart seen = equiangularPart(sqrt(dot(off, off) + light.radius * light.radius),
                                                 near * ray_metres - closest, far * ray_metres - closest);
    const vec3 place = foot + equiangularPlace(seen, angle_part) * ray_unit;
    return ofLightAt(i, place, equiangularWeight(seen) / ((far - near) * ray_metres));
}

// The same with the inverse square at x.
vec3 ofLightThere(uint i, vec3 x) {
    const vec3 away = x - local_lights[i].position;
    const float radius = local_lights[i].radius;
    return ofLightAt(i, x, 1 / max(dot(away, away) + radius * radius, 1e-12));
}

// Optical depth of the particles in a slice, and the part of it that scatters each colour.
float particlesIn(float near, float far, out vec3 scattering);

// The same, if all is as at the slice's sample.
float particlesAtSample(float near, float far, out vec3 scattering) {
    const float metres = (far - near) * ray_metres;
    const float depth = metres * mediumAt(eye.position + sampledDepth(near, far) * ray_dir, scattering);
    scattering *= metres;
    return depth;
}

// Finds the media of a slice. Returns their optical depth; adds what they emit and scatter of ambient light.
float mediaOf(float near, float far, inout vec3 scattered) {
    of_particles = vec3(0);
    float depth = hasParticles() ? particlesIn(near, far, of_particles) : 0;
    vec3 all = of_particles;
    [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i) {
        const float own =
            depthInFog(i, eye.position, ray_dir, ray_metres, partInFog(i, eye.position, ray_dir, near, far));
        of_fogs[i] = own * tick.fogs[i].albedo;
        all += of_fogs[i];
        depth += own;
        if (kHasGlow) scattered += own * tick.fogs[i].emission;
    }
    if (kHasAmbient) scattered += all * tick.ambient;
    return depth;
}

// The part of the sun's light that media let through to x.
float sunThrough(vec3 x) {
    const float toward = lightDepthAnywhere(toShadowVolume(x)) + (kHasFog ? fogTowardSun(x) : 0);
    return toward < 30 ? exp(-toward) : 0;
}
