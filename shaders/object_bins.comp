#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Object bins, per eye: which boxes and spheres the rays of a bin of pixels may hit. A lane is a bin. It goes from near
// objects to far ones, and ends behind one that fills the bin.
#include "shaders/shared/types.h"

layout(local_size_x = 64) in;

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) buffer ObjectBins { uint object_bins[]; };
layout(scalar) readonly buffer ObjectOrder { uint object_order[]; };

#include "shaders/lib/eye.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/object_bins.glsl"

vec3 corners[4]; // rays through the bin's corners

// View depth before which all rays of the bin hit the object; kMiss if some do not. It is convex: where the corners'
// rays hit it, all do, and the deepest hit is at a corner.
float filledDepth(Opaque o) {
    float deepest = 0;
    vec3 n;
    for (uint i = 0; i < 4; ++i) {
        const float t = hitObject(o, eye.position, corners[i], n);
        deepest = max(deepest, t >= eye.near_depth ? t : kMiss);
    }
    return deepest;
}

void main() {
    const uvec2 bins = objectBins();
    const uint bin = gl_GlobalInvocationID.x;
    if (bin >= bins.x * bins.y) return;
    const vec2 first = vec2(bin % bins.x, bin / bins.x) * float(kObjectBin);
    const vec3 middle = normalize(rayDirection(first + 0.5 * float(kObjectBin)));
    float cosine = 1; // of the cone of the bin's rays. Pictures are flat: the corners are furthest from the middle
    for (uint i = 0; i < 4; ++i) {
        corners[i] = rayDirection(first + vec2(i & 1, i >> 1) * float(kObjectBin));
        cosine = min(cosine, dot(middle, normalize(corners[i])));
    }
    const float sine = sqrt(max(1 - cosine * cosine, 0)) * 1.001 + 1e-4;
    const uint at = objectBin(bin), count = tick.opaque_count - tick.plane_count;
    float filled = kMiss; // least view depth before which one object fills the bin
    uint words = 0;       // bits of words that are not 0
    [[dont_unroll]] for (uint word = 0; word < objectWords(); ++word) {
        uint bits = 0;
        [[dont_unroll]] for (uint i = 32 * word; i < min(32 * word + 32, count); ++i) {
            const Opaque o = objects[object_order[i]];
            const vec3 to = o.centre - eye.position;
            if (bodyBegin(o, o.kind, to) > filled) break;
            const float reach = bodyReach(o, o.kind), along = dot(to, middle);
            const float across = sqrt(max(dot(to, to) - along * along, 0));
            const bool near = dot(to, to) <= reach * reach;
            if (!near && (along < -reach || across * cosine - along * sine > reach)) continue;
            bits |= 1u << (i & 31);
            filled = min(filled, filledDepth(o));
        }
        object_bins[at + wordsOfWords() + word] = bits;
        if (bits != 0) words |= 1u << (word & 31);
        if ((word & 31) == 31 || word + 1 == objectWords()) {
            object_bins[at + word / 32] = words;
            words = 0;
        }
    }
}
