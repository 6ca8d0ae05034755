// Shading of one particle's interval on a pixel's ray, shared by all raster methods. Include after the
// eye.
#include "shaders/blocks/opaque_shadow.glsl"
#include "shaders/blocks/shadow_volume.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/blocks/view_depth.glsl"
#include "shaders/shared/constants.h"
#include "shaders/lib/medium_phase.glsl"
#include "shaders/shared/scatter.h"
#include "shaders/lib/eye.glsl"

// Code for features that a scene lacks is compiled out.
layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdHasLobe) const bool kHasLobe = true;
layout(constant_id = kIdHasAmbient) const bool kHasAmbient = true;
layout(constant_id = kIdMayBeCut) const bool kMayBeCut = true;
layout(constant_id = kIdSoftShadows) const bool kSoftShadows = false;

#include "shaders/lib/even_light.glsl"
#include "shaders/lib/light.glsl"

// True if the medium is in this pixel already (drawn_cells.comp).
bool isFinished() { return kHasOpaque && texelFetch(view_depth, ivec2(gl_FragCoord.xy), 0).r == 0; }

// The pixel's ray relative to a particle.
struct RayParticle {
    vec3 w;          // unit direction of the ray
    float closest;   // m along the ray, of the closest approach to the centre
    float b2;        // m^2, squared distance there
    float begin, end; // m along the ray: near plane and opaque surface
    vec3 volume_per_m; // change of position in the volumetric shadow map per metre of the ray
};

RayParticle rayParticle(vec3 centre) {
    RayParticle ray;
    const vec3 dir = rayDirection(gl_FragCoord.xy);
    const float inverse_length = inversesqrt(dot(dir, dir));
    const float per_depth = dot(dir, dir) * inverse_length; // m along the ray per m of view depth
    ray.w = dir * inverse_length;
    ray.closest = dot(centre, ray.w);
    const vec3 off = centre - ray.closest * ray.w; // never |c|^2 - closest^2
    ray.b2 = dot(off, off);
    ray.begin = eye.near_depth * per_depth;
    ray.end = kHasOpaque ? texelFetch(view_depth, ivec2(gl_FragCoord.xy), 0).r * per_depth : 1e30;
    ray.volume_per_m =
        inverse_length * (map_rays.ray + gl_FragCoord.x * map_rays.right + gl_FragCoord.y * map_rays.down);
    return ray;
}

// Light optical depth, and visibility past the opaque objects, at `t` m along the ray.
float lightDepthAt(RayParticle ray, float t) { return lightDepth(map_rays.eye + t * ray.volume_per_m); }
float visibilityAt(RayParticle ray, float t) {
    const vec3 at = toLightSpace(eye.position + t * ray.w);
    return kSoftShadows ? visibilitySoft(at) : visibility(at);
}

// T_L * Vis at `t` m along the ray.
float lightArriving(RayParticle ray, float t) {
    float light = exp(-lightDepthAt(ray, t));
    if (kHasCasters) light *= visibilityAt(ray, t);
    return light;
}

// The pixel's premultiplied radiance and transmittance: `scattered` = integral of T_L T_V Vis sigma dz, `depth` =
// optical depth.
vec4 composed(RayParticle ray, vec3 albedo, float scattered, float depth) {
    const float opaque_part = opacity(depth);
    float phase = 0.07957747154594767;
    if (kHasLobe) phase = mediumPhase(-tick.sun.to_light, -ray.w);
    vec3 radiance = albedo * tick.sun.irradiance * (phase * scattered);
    radiance += evenLight(opaque_part, albedo * opaque_part);
    return vec4(radiance, 1 - opaque_part);
}
