#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `gradients`: computes light at samples, and its derivatives. A sample that does not interpolate well within
// its sphere is dropped, and those of the next grid in that sphere are wanted. A lane is a sample of push.level.
#include "shaders/lib/radiance_inputs.glsl"

layout(local_size_x = 64) in;

layout(scalar) writeonly buffer Samples { LightSample samples[]; };
layout(scalar) buffer States { uint states[]; };
layout(scalar) buffer Spheres { vec4 spheres[]; }; // of the first samples: place, radius (m)
// With kShadingError: places of viewers, and of samples the bits of the transmittance to them.
layout(scalar) readonly buffer Viewers { vec4 viewers[]; };
layout(scalar) buffer Through { uint through[]; };
#include "shaders/blocks/particles.glsl"

#include "shaders/lib/radiance.glsl"
#include "shaders/lib/sphere_samples.glsl"

const float kDeviationRadii = 4.242640687; // 3 sqrt(2): 3 r_j of exp(-x^2 / r_j^2)
const float kTestedAt = 0.6;               // of the radius; as printed it is 1, where weights end

// The same numbers for the same cell: Jarzynski and Olano, Hash Functions for GPU Rendering, 2020 (pcg3d).
vec3 jitterOf(uvec3 v) {
    v = v * 1664525u + 1013904223u;
    v += v.yzx * v.zxy;
    v ^= v >> 16u;
    v += v.yzx * v.zxy;
    return vec3(v >> 8u) / 16777216.0;
}

// The sphere of a first sample: of a particle, or of a stratum, in which its place is by chance.
vec4 firstSphere(uint i) {
    if (isHow(kParticles)) {
        const Particle p = particles[i];
        return vec4(p.centre, kDeviationRadii * 0.1 * p.scale * tick.falloff);
    }
    const vec3 size = (vec3(push.lit.bricks * kSlabTile) - 1) * push.lit.spacing;
    float stratum = pow(size.x * size.y * size.z / float(push.firsts), 1.0 / 3);
    uvec3 strata = max(uvec3(size / stratum), uvec3(1));
    // In a flat box one is as high as the box.
    [[dont_unroll]] for (uint round = 0; round < 200 && strata.x * strata.y * strata.z > push.firsts; ++round) {
        stratum *= 1.05;
        strata = max(uvec3(size / stratum), uvec3(1));
    }
    if (i >= strata.x * strata.y * strata.z) return vec4(push.lit.origin, 0);
    const uvec3 at = uvec3(i % strata.x, i / strata.x % strata.y, i / (strata.x * strata.y));
    const vec3 wide = size / vec3(strata);
    return vec4(push.lit.origin + wide * (vec3(at) + jitterOf(at)), length(wide)); // nothing is between spheres
}

// Of the medium between x and the viewer that sees x best.
float throughToViewers(vec3 x) {
    float most = 0;
    [[dont_unroll]] for (uint i = 0; i < push.viewers; ++i) {
        const vec3 way = viewers[i].xyz - x;
        const float distance = length(way);
        const vec3 dir = way / max(distance, 1e-20);
        const float particles = tick.particle_count > 0 ? marchedDepth(x, dir, distance) : 0;
        most = max(most, exp(-particles - (kHasFog ? fogBetween(x, dir, 1, 0, distance) : 0)));
    }
    return most;
}

// Wants all samples of the next grid in the sphere, which have its transmittance. False: there are none.
bool wantNext(vec3 x, float radius, float passed) {
    const int next = push.level + 1;
    const uvec3 size = gridSize(next);
    const float cell = gridCell(next);
    const ivec3 lo = max(ivec3(ceil((x - radius - push.lit.origin) / cell)), ivec3(0)),
                hi = min(ivec3(floor((x + radius - push.lit.origin) / cell)), ivec3(size) - 1);
    const uint first = firstOf(next);
    bool any = false;
    for (int k = lo.z; k <= hi.z; ++k)
        for (int j = lo.y; j <= hi.y; ++j)
            for (int i = lo.x; i <= hi.x; ++i) {
                const vec3 off = push.lit.origin + cell * vec3(i, j, k) - x;
                if (dot(off, off) > radius * radius) continue;
                const uint at = first + sampleAt(uvec3(i, j, k), size);
                states[at] = kWanted;
                if (isHow(kShadingError)) atomicMax(through[at], floatBitsToUint(passed)); // the most of all spheres
                any = true;
            }
    return any;
}

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64 + gl_LocalInvocationIndex;
    vec3 x;
    float radius;
    if (push.level < 0) {
        if (i >= push.firsts) return;
        const vec4 sphere = firstSphere(i);
        spheres[i] = sphere;
        if (!(sphere.w > 0)) return;
        x = sphere.xyz, radius = sphere.w;
    } else {
        const uvec3 size = gridSize(push.level);
        if (i >= size.x * size.y * size.z) return;
        radius = gridCell(push.level);
        x = push.lit.origin + radius * vec3(i % size.x, i / size.x % size.y, i / (size.x * size.y));
        i += firstOf(push.level);
        if (states[i] != kWanted) return;
    }
    if (kHasOpaque && isInSolid(x)) return; // it is dark there, and says nothing of what is around
    LightSample made;
    made.value = lightAt(x);
    const float apart = push.lit.spacing; // a step of differences: nearer places are not resolved by nodes
    [[dont_unroll]] for (uint axis = 0; axis < 3; ++axis) {
        vec3 along = vec3(0);
        along[axis] = apart;
        made.along[axis] = isHow(kNoPlanes) ? vec4(0) : (lightAt(x + along) - lightAt(x - along)) / (2 * apart);
    }
    bool keep = push.level + 1 >= int(push.levels);
    if (!keep) {
        float worth = 0;
        [[dont_unroll]] for (uint test = 0; test < 6; ++test) {
            vec3 off = vec3(0);
            const float tested = isHow(kPrinted | kShadingError) ? radius : kTestedAt * radius;
            off[test / 2] = (test & 1) == 0 ? tested : -tested;
            vec4 plane = made.value + made.along[test / 2] * off[test / 2];
            plane = isHow(kRadiance) ? max(plane, 0) : clamp(plane, 0, 1);
            worth += worthOf(plane - lightAt(x + off), x + off) / 6;
        }
        float passed = 1;
        if (isHow(kShadingError)) {
            passed = push.level < 0 ? throughToViewers(x) : uintBitsToFloat(through[i]);
            worth = shadingError(radius / longestSide(), worth, passed);
        }
        // One without samples of the next grid in its sphere would leave a hole.
        keep = worth <= push.error || (!wantNext(x, radius, passed) && !isHow(kPrinted));
    }
    atomicAdd(counts[kPlacesLit], places_lit);
    if (keep) atomicAdd(counts[kSamplesKept], 1);
    samples[i] = made;
    states[i] = keep ? kKept : kNoSample;
}
