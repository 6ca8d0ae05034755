// Background: the sky, and opaque objects lit through the medium. Include after the eye.
#include "shaders/blocks/light_bits.glsl"
#include "shaders/blocks/light_depths.glsl"
#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/meshes.glsl"
#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/opaque_shadow.glsl"
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/shadow_volume.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/constants.h"
#include "shaders/shared/splat.h"

layout(scalar) readonly buffer ObjectBins { uint object_bins[]; };
layout(scalar) readonly buffer ObjectOrder { uint object_order[]; };
// Of a union medium.
layout(scalar) readonly buffer UnionBits { uint union_bits[]; };
layout(scalar) readonly buffer UnionLights { ParticleLight union_lights[]; };

// Number of objects of each kind, stored in this order. Loops over a few are unrolled; code for none is removed.
layout(constant_id = kIdPlanes) const uint kPlanes = 1;
layout(constant_id = kIdBoxes) const uint kBoxes = 1;
layout(constant_id = kIdSpheres) const uint kSpheres = 1;
layout(constant_id = kIdManyObjects) const bool kMany = false;
layout(constant_id = kIdHasStructure) const bool kHasStructure = false;
layout(constant_id = kIdUnion) const bool kUnion = false;
const bool kHasBodies = kBoxes + kSpheres > 0;

#include "shaders/lib/objects.glsl"
#include "shaders/lib/object_bins.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/medium_glow.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/eye.glsl"
#include "shaders/lib/sky.glsl"
#include "shaders/lib/local_lights.glsl"
#include "shaders/lib/local_light_depth.glsl"

#include "shaders/lib/body_hits.glsl"
#include "shaders/lib/mesh_hits.glsl"
#include "shaders/shared/ground.h"
#include "shaders/lib/union_ray.glsl"

const uint kNone = ~0u;
const uint kOfMesh = 0x80000000u; // bit of Hit::object: the rest is the index of a triangle

// The first object that a ray hits.
struct Hit {
    float depth; // view depth; kMiss if there is none
    uint object; // kNone
    vec3 normal, albedo;
};

uint object_bin; // with kMany: index in object_bins of the pixel's bin

// Most distance of the samples' rays from the one through the pixel's centre, at view depth 1: they are at most 3/8
// pixels from it in x and y.
float pixelReach() { return 0.61 * (length(eye.ray_right) + length(eye.ray_down)); }

// Bits of boxes and spheres that may be hit, of few: the scene's first one, its second one ...
uint mayHit(vec3 middle) {
    uint may = 0;
    for (uint n = 0; n < (kMany ? 0 : kBoxes + kSpheres); ++n) {
        const Opaque o = objects[kPlanes + n];
        if (mayHit(o, n < kBoxes ? kBox : kSphere, o.centre - eye.position, middle, pixelReach())) may |= 1u << n;
    }
    return may;
}

void meet(uint i, uint kind, vec3 dir, inout Hit hit) {
    Opaque o = objects[i];
    o.kind = kind;
    vec3 n;
    const float t = hitObject(o, eye.position, dir, n);
    if (t >= eye.near_depth && t < hit.depth) hit = Hit(t, i, n, o.albedo);
}

Hit nearest(vec3 dir, uint may) {
    Hit hit = Hit(kMiss, kNone, vec3(0, 1, 0), vec3(0));
    for (uint i = 0; i < kPlanes; ++i) meet(i, kPlane, dir, hit);
    for (uint n = 0; n < (kMany ? 0 : kBoxes + kSpheres); ++n)
        if ((may & 1u << n) != 0) meet(kPlanes + n, n < kBoxes ? kBox : kSphere, dir, hit);
    return hit;
}

// The box or sphere that one of the pixel's rays has hit, if it is before `hit`.
void meetBody(uint n, vec3 dir, inout Hit hit) {
    if (body_depth[n] < hit.depth) meet(body_hit[n], objects[body_hit[n]].kind, dir, hit);
}

// The triangle that one of the pixel's rays has hit, if it is before `hit`.
void meetMesh(uint n, vec3 dir, inout Hit hit) {
    if (!(mesh_depth[n] < hit.depth)) return;
    const Triangle triangle = triangles[mesh_hit[n]];
    const vec3 normal = normalize(cross(triangle.b - triangle.a, triangle.c - triangle.a));
    hit = Hit(mesh_depth[n], kOfMesh | mesh_hit[n], dot(normal, dir) < 0 ? normal : -normal, triangle.albedo);
}

// The first hit of one of the pixel's rays: 0: through its centre, 1 ... 4: of its samples.
Hit nearest(uint n, vec3 dir, uint may) {
    Hit hit = nearest(dir, may);
    if (kMany && kHasBodies) meetBody(n, dir, hit);
    if (kHasMeshes) meetMesh(n, dir, hit);
    return hit;
}

// True if an edge is between two hits of one pixel. Triangles beside each other in a plane have none.
bool areApart(Hit a, Hit b) {
    if (!kHasMeshes || a.object == b.object || (a.object & b.object & kOfMesh) == 0 || a.object == kNone ||
        b.object == kNone)
        return a.object != b.object;
    const Triangle one = triangles[a.object & ~kOfMesh], other = triangles[b.object & ~kOfMesh];
    const float off = abs(dot(a.normal, other.a - one.a)), size = length(other.a - one.a);
    return a.albedo != b.albedo || dot(a.normal, b.normal) < 0.9999 || off > 1e-3 * size;
}

// Index of the triangle that is hit; kInnerNode: none is.
uint ownTriangle(Hit hit) {
    return hit.object != kNone && (hit.object & kOfMesh) != 0 ? hit.object & ~kOfMesh : kInnerNode;
}

uint light_bin; // index of the pixel's bin in light_bits

// Irradiance that local lights give a surface.
vec3 localIrradiance(Hit hit, vec3 x) {
    vec3 sum = vec3(0);
    for (uint word = 0; word < lightWords(); ++word)
        for (uint bits = light_bits[light_bin + word]; bits != 0; bits &= bits - 1) {
            const LocalLight light = local_lights[32 * word + findLSB(bits)];
            const vec3 away = x - light.position;
            const float distance = length(away), cosine = -dot(hit.normal, away) / max(distance, 1e-20);
            const float sent = cosine > 0 ? sentTo(light, away, distance) : 0;
            if (!(sent > 0)) continue;
            if (light.shadows != 0 && isHidden(light, x, hit.object)) continue;
            if (kHasMeshes && light.shadows != 0 &&
                isShadowedByMesh(x, -away, 1, ownTriangle(hit), length(x - eye.position)))
                continue;
            const float fog = kHasFog ? fogFrom(light, away, distance) : 0;
            const float through = exp(-fog - particlesFrom(light, away, distance));
            sum += light.intensity * (cosine * sent * through / (distance * distance + light.radius * light.radius));
        }
    return sum;
}

// The part of the sun's light that particles let through to a surface.
float throughParticles(vec3 x) {
    if (!kUnion) {
        const vec3 at = toShadowVolume(x); // there is no medium beside and above the map
        return at.z > 0 && all(lessThan(abs(at.xy - 0.5), vec2(0.5))) ? exp(-lightDepth(at)) : 1;
    }
    if (tick.balls.surfaces == kUnionNone) return 1;
    const UnionRay ray = unionRay(x);
    if (ray.nearest == kNoUnionBall) return 1;
    if (tick.balls.surfaces == kUnionBinary) return 0;
    if (tick.balls.surfaces == kUnionNearest) return union_lights[ray.nearest].transmittance;
    return exp(-tick.extinction * tick.balls.sigma_t * ray.path);
}

// Radiance of a surface by Lambert's law: of the lights, past objects and medium, and of the whole sky.
vec3 lit(Hit hit, vec3 x) {
    const vec3 n = hit.normal;
    const float cosine = dot(n, tick.sun.to_light);
    float direct = max(cosine, 0) / 3.14159265;
    if (kHasBodies)
        if (direct > 0) {
            const float texel = (tick.map.opaque_hi.x - tick.map.opaque_lo.x) / float(tick.map.opaque_size);
            const float slope = texel * 2 * sqrt(max(1 - cosine * cosine, 0)) / max(cosine, 0.1);
            direct *= visibilityFiltered(toLightSpace(x + n * 2 * texel), slope);
        }
    if (kHasMeshes && direct > 0)
        if (isShadowedByMesh(x, tick.sun.to_light, kNoTriangle, ownTriangle(hit), length(x - eye.position))) direct = 0;
    if (direct > 0) direct *= throughParticles(x);
    if (kHasFog && direct > 0) direct *= exp(-fogTowardSun(x));
    vec3 light = skyLight(n) + tick.sun.irradiance * direct;
    if (kHasLocalLights) light += localIrradiance(hit, x) / 3.14159265;
    if (kMediumGlow) light += mediumIrradiance(x, n) / 3.14159265;
    return hit.albedo * light;
}

// Albedo of a plane that is hit along `dir`, over the pixel.
vec3 structuredAlbedo(Hit hit, vec3 dir) {
    const vec3 x = eye.position + hit.depth * dir, plane = objects[hit.object].half_size;
    const vec3 a = groundFootprint(dir, eye.ray_right, hit.depth), b = groundFootprint(dir, eye.ray_down, hit.depth);
    return groundAlbedo(hit.albedo, plane.x, groundStructure(x.x, x.z, a, b, plane.y));
}

vec3 shade(vec3 dir, Hit hit) {
    const vec3 w = normalize(dir);
    if (kHasStructure && hit.object < kPlanes) hit.albedo = structuredAlbedo(hit, dir);
    vec3 colour = skyRadiance(w);
    if (hit.object != kNone) colour = throughHaze(lit(hit, eye.position + hit.depth * dir), hit.depth * dot(dir, w), w);
    return colour;
}

// Radiance of a pixel, and the view depth of the object at its centre. Edges are smoothed: four rays are averaged if
// they do not all hit the centre's object.
vec3 background(vec2 centre, out float view_depth) {
    const vec2 offsets[4] = vec2[](vec2(-0.375, -0.125), vec2(0.125, -0.375), vec2(0.375, 0.125), vec2(-0.125, 0.375));
    const vec3 middle = rayDirection(centre);
    if (kHasLocalLights) light_bin = binOf(uvec2(centre));
    uint may = 0;
    if (kMany) object_bin = objectBinOf(uvec2(centre));
    if (kHasBodies) may = mayHit(middle);
    const vec3 rays[kPixelRays] =
        vec3[](middle, rayDirection(centre + offsets[0]), rayDirection(centre + offsets[1]),
               rayDirection(centre + offsets[2]), rayDirection(centre + offsets[3]));
    if (kMany && kHasBodies)
        hitBodies(object_bin, kSpheres == 0 ? 0 : kBoxes == 0 ? 1 : 2, middle, rays, pixelReach());
    if (kHasMeshes) hitMeshes(middle, rays, pixelReach());
    const Hit hit = nearest(0, middle, may);
    view_depth = hit.depth;
    bool edge = false;
    if (kPlanes > 0 || kHasBodies || kHasMeshes)
        edge = areApart(nearest(1, rayDirection(centre + offsets[0]), may), hit) ||
               areApart(nearest(2, rayDirection(centre + offsets[1]), may), hit) ||
               areApart(nearest(3, rayDirection(centre + offsets[2]), may), hit) ||
               areApart(nearest(4, rayDirection(centre + offsets[3]), may), hit);
    vec3 colour = vec3(0);
    const uint samples = edge ? 4 : 1;
    for (uint i = 0; i < samples; ++i) {
        const vec3 dir = edge ? rayDirection(centre + offsets[i]) : middle;
        Hit here = hit;
        if (edge) here = nearest(i + 1, dir, may);
        colour += shade(dir, here);
    }
    return colour / float(samples);
}
