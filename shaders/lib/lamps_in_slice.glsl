// Light of points and spots that the media of a slice of a ray scatter toward the eye. Include after
// lib/march_ray.glsl, lib/local_lights.glsl and lib/local_light_depth.glsl.
#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/equiangular.h"
#include "shaders/shared/phase.h"

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

// The part of the ray between two view depths as a light sees it. foot: the place of the ray closest to the light.
EquiangularPart seenFrom(LocalLight light, float near, float far, out vec3 foot) {
    const float closest = dot(light.position - eye.position, ray_unit);
    foot = eye.position + closest * ray_unit;
    const vec3 off = foot - light.position;
    return equiangularPart(sqrt(dot(off, off) + light.radius * light.radius), near * ray_metres - closest,
                           far * ray_metres - closest);
}

// The same with the mean of the inverse square over the slice. All else is looked up where half of the light comes from
// (shared/equiangular.h), or the part `angle_part` of it: one sample in the middle is 3.6 times too bright a tenth of a
// slice beside a light.
vec3 ofLocalLight(uint i, float near, float far) {
    vec3 foot;
    const EquiangularPart seen = seenFrom(local_lights[i], near, far, foot);
    const vec3 place = foot + equiangularPlace(seen, angle_part) * ray_unit;
    return ofLightAt(i, place, equiangularWeight(seen) / ((far - near) * ray_metres));
}

// The same with all else as at x. Precondition: far > near.
vec3 ofLightAround(uint i, vec3 x, float near, float far) {
    vec3 foot;
    return ofLightAt(i, x, equiangularWeight(seenFrom(local_lights[i], near, far, foot)) / ((far - near) * ray_metres));
}

// The same with the inverse square at x.
vec3 ofLightThere(uint i, vec3 x) {
    const vec3 away = x - local_lights[i].position;
    const float radius = local_lights[i].radius;
    return ofLightAt(i, x, 1 / max(dot(away, away) + radius * radius, 1e-12));
}
