#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Method `gradients`, last pass: the light at each node, from samples in spheres, from nested grids, or computed. What
// is written is what lit_grid.comp writes. A workgroup is a brick, a lane a column of nodes.
#include "shaders/lib/radiance_inputs.glsl"

layout(local_size_x = 8, local_size_y = 8) in; // kSlabTile

layout(scalar) writeonly buffer LitNodes { float lit_nodes[]; };
layout(scalar) writeonly buffer SunNodes { float sun_nodes[]; };
layout(scalar) readonly buffer Samples { LightSample samples[]; };
layout(scalar) readonly buffer States { uint states[]; };
layout(scalar) readonly buffer Spheres { vec4 spheres[]; };
layout(scalar) readonly buffer Values { vec4 values[]; };

#include "shaders/lib/radiance.glsl"
#include "shaders/lib/sphere_samples.glsl"

const float kNoValue = -3e38;  // the value of a node that nothing has written; it becomes no light
const float kSeen = 1e-4;      // opacity of the medium all through the box: light in less is not seen
const uint kMostFirsts = 16384; // samples before those of grids
shared uint near_firsts[kMostFirsts / 32]; // bits of those whose spheres meet the brick

// Finds the first samples that nodes of the brick may lie in.
void findFirsts(vec3 lo, vec3 hi) {
    const uint words = (push.firsts + 31) / 32;
    for (uint w = gl_LocalInvocationIndex; w < words; w += 64) {
        uint bits = 0;
        for (uint bit = 0; bit < 32 && 32 * w + bit < push.firsts; ++bit) {
            const uint i = 32 * w + bit;
            if (states[i] != kKept) continue;
            const vec4 sphere = spheres[i];
            const vec3 off = clamp(sphere.xyz, lo, hi) - sphere.xyz;
            if (dot(off, off) < sphere.w * sphere.w) bits |= 1u << bit;
        }
        near_firsts[w] = bits;
    }
    barrier();
}

// Adds a sample to what spheres say of the light at a place.
void addSample(uint i, vec3 off, float radius, inout vec4 sum, inout float weights) {
    const float weight = sampleWeight(length(off) / radius, isHow(kPrinted));
    if (!(weight > 0)) return;
    vec4 value = samples[i].value;
    if (!isHow(kNoPlanes))
        value += off.x * samples[i].along[0] + off.y * samples[i].along[1] + off.z * samples[i].along[2];
    sum += weight * value;
    weights += weight;
}

// False: no sample reaches x, and `value` is as it was.
bool fromSpheres(vec3 x, inout vec4 value) {
    vec4 sum = vec4(0);
    float weights = 0;
    [[dont_unroll]] for (uint w = 0; w < (push.firsts + 31) / 32; ++w)
        [[dont_unroll]] for (uint bits = near_firsts[w]; bits != 0; bits &= bits - 1) {
            const uint i = 32 * w + findLSB(bits);
            addSample(i, x - spheres[i].xyz, spheres[i].w, sum, weights);
        }
    uint first = push.firsts;
    [[dont_unroll]] for (int level = 0; level < int(push.levels); ++level) {
        const uvec3 size = gridSize(level);
        const float cell = gridCell(level);
        const vec3 at = (x - push.lit.origin) / cell;
        const uvec3 corner = uvec3(clamp(at, vec3(0), vec3(size) - 2));
        [[dont_unroll]] for (uint c = 0; c < 8; ++c) {
            const uvec3 vertex = corner + uvec3(c & 1, c >> 1 & 1, c >> 2);
            const uint i = first + sampleAt(vertex, size);
            if (states[i] == kKept) addSample(i, cell * (at - vec3(vertex)), cell, sum, weights);
        }
        first += size.x * size.y * size.z;
    }
    if (!(weights > 0)) return false;
    value = sum / max(weights, 1e-30);
    return true;
}

void main() {
    const uvec3 brick = gl_WorkGroupID;
    const bool known = push.lit.particles == 0 || (marks[markWord(kRead, brick)] >> (brick.x % 32) & 1) != 0;
    if (!known) return; // nothing reads it
    const uvec3 size = push.lit.bricks * kSlabTile;
    const bool spheres_say = !isHow(kExactly | kNested);
    if (spheres_say) {
        const vec3 lo = push.lit.origin + push.lit.spacing * vec3(brick * kSlabTile);
        findFirsts(lo, lo + push.lit.spacing * float(kSlabTile - 1));
    }
    [[dont_unroll]] for (uint z = 0; z < kSlabTile; ++z) {
        const uvec3 node = brick * kSlabTile + uvec3(gl_LocalInvocationID.xy, z);
        const uint at = (node.z * size.y + node.y) * size.x + node.x;
        const vec3 x = push.lit.origin + push.lit.spacing * vec3(node);
        vec4 value = vec4(kNoValue);
        if (isHow(kExactly)) {
            value = lightAt(x);
        } else if (isHow(kNested)) {
            value = values[at];
        } else if (!fromSpheres(x, value) && !isHow(kPrinted) && opacityAround(x) > kSeen) {
            value = lightAt(x);
            atomicAdd(counts[kNodesLit], 1);
        }
        // A hole is where the medium is seen and nothing of the above has written a value.
        if (value.w == kNoValue && opacityAround(x) > kSeen) atomicAdd(counts[kHoles], 1);
        value = isHow(kRadiance) ? max(value, 0) : clamp(value, 0, 1);
        sun_nodes[at] = min(value.w, 1);
        if (!kHasLocalLights) continue;
        const bool fluence = push.lit.keeps == kKeepsFluence; // nothing is known of its directions
        const uint first = push.lit.numbers * at;
        [[unroll]] for (uint c = 0; c < 3; ++c) {
            if (fluence) lit_nodes[first + 4 * c] = lit_nodes[first + 4 * c + 1] = lit_nodes[first + 4 * c + 2] = 0;
            lit_nodes[first + (fluence ? 4 * c + 3 : c)] = value[c];
        }
    }
    if (places_lit > 0) atomicAdd(counts[kPlacesLit], places_lit);
}
