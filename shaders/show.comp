#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Views of how a picture is made, drawn over a finished picture's planes: one after compose, of what the tick, its
// particles and maps and the eye tell. All particles are asked, or one in push.every; a workgroup leaves out those
// beside its tile. A lane computes kSide x kSide squares of push.step pixels. Where a view has nothing to say, the
// picture shows, dimmed.
#define BRUME_BLOCK_TICK // the tick below is this shader's own
#include "shaders/shared/constants.h"
#include "shaders/shared/types.h"
#include "shaders/shared/show.h"
#include "shaders/shared/show_colours.h"
#include "shaders/shared/support.h"
#include "shaders/shared/orientation.h"
#include "shaders/shared/transmittance.h"
#include "shaders/lib/view.glsl"

layout(local_size_x = 16, local_size_y = 16) in;

layout(constant_id = kIdShow) const uint kShow = kShowOverdraw;
layout(constant_id = kIdFading) const bool kFading = true; // false: all of a tetrahedron has its centre's extinction
layout(constant_id = kIdTurned) const bool kTurned = false; // these two: as isv.vert
layout(constant_id = kIdDropsNear) const bool kDropsNear = false;
layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;

layout(scalar) uniform TickBlock { Tick tick_block; };
#include "shaders/blocks/particles.glsl"
#include "shaders/blocks/shadow_volume.glsl"
#include "shaders/blocks/view_depth.glsl"
layout(scalar) buffer Planes { uint planes[]; };
layout(scalar) readonly buffer Legends { uint legends[]; };
layout(scalar) readonly buffer Discs { ErrorDisc discs[]; };

layout(push_constant, scalar) uniform Push { ShowPush push; };

Tick tick; // of the extinction itself, whatever hue is drawn

#include "shaders/lib/early_return.glsl"
#include "shaders/lib/eye.glsl"
#include "shaders/lib/tiles.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/planes.glsl"

const uint kLanes = 256;
const uint kSide = kShow == kShowRays ? 1 : 2;
const uint kOwn = kSide * kSide; // squares of a lane
const uint kSquares = 16 * kSide; // along a side of the tile
const uint kWords = kShow == kShowRays ? 16 : 1; // of bits for slabs
const float kFar = 1e8; // m
const float kDisc = 0.15; // radius of a particle's disc, over its scale
const float kRim = 0.85;  // from here on a disc is black, over its radius: if that is 4 pixels at least
const float kErrorDisc = 1.0 / 90; // radius, over the picture's height

shared uint colours[kSquares * kSquares];
shared vec4 item[kLanes];    // centre relative to the eye (m), scale; of an error: its pixel, the error
shared vec2 amount[kLanes];  // extinction at the centre (1/m), radius (m); of `light`: the light's part
shared uint taken[kLanes / 32];
shared vec4 orientation[kTurned ? kLanes : 1]; // rotations of the particles' tetrahedra

// The ray of a square's middle, and what was gathered on it.
struct Pixel {
    vec3 dir; // of unit view depth
    float depth; // m, of the surface there
    vec2 sum;
};
Pixel own[kOwn];
uint bits[kWords];

// True: what is drawn of a particle is its tetrahedron.
bool isTetrahedron() { return kShow == kShowWasted || (kShow == kShowOverdraw && push.spheres == 0); }

float radiusOf(float scale, float sigma_t) {
    const float support = supportRadius(sigma_t, scale * tick.falloff, tick.cut);
    if (kShow == kShowDepth) return 4 / gaussianK(scale, tick.falloff); // beyond, there is a part of 1e-8
    if (kShow == kShowLight) return support < 0 ? support : kDisc * scale;
    return isTetrahedron() && (support > 0 || !kFading) ? scale : support;
}

// True: the ball meets the cone and is not behind the near plane.
bool meets(PixelCone cone, vec3 centre, float radius) {
    if (!(radius > 0) || !(radius - dot(eye.back, centre) > eye.near_depth)) return false;
    const float away = length(centre);
    if (away <= radius) return true;
    const float sine = radius / away, chord = sqrt(max(2 - 2 * sqrt(1 - sine * sine), 0));
    return distance(centre / away, cone.direction) <= chord + cone.chord;
}

// Loads one of all items; false if the tile does not need it.
bool load(uint i, uint slot, PixelCone cone, vec2 middle, float half_tile) {
    if (kShow == kShowError) {
        const ErrorDisc disc = discs[push.first_disc + i];
        item[slot] = vec4(disc.at * vec2(eye.size), disc.error, 0);
        const vec2 away = abs(item[slot].xy - middle);
        return max(away.x, away.y) < half_tile + 1 + kErrorDisc * float(eye.size.y);
    }
    const Particle p = particles[push.every * i];
    const float radius = radiusOf(p.scale, p.sigma_t);
    item[slot] = vec4(p.centre - eye.position, p.scale);
    amount[slot] = vec2(p.sigma_t, radius);
    bool is_near = meets(cone, item[slot].xyz, radius);
    if (kTurned) orientation[slot] = orientationOf(push.every * i);
    if (kDropsNear && isTetrahedron() && -dot(eye.back, item[slot].xyz) - p.scale < eye.near_depth) is_near = false;
    if (kShow == kShowLight && is_near) {
        float light = exp(-lightDepthAnywhere(toShadowVolume(p.centre)));
        if (kHasCasters) light *= visibility(toLightSpace(p.centre));
        amount[slot].x = light;
    }
    return is_near;
}

// The part of a ray, m along it, in the particle's tetrahedron.
vec2 inTetrahedron(vec3 w, vec3 centre, float scale) {
    const vec3 normal[4] =
        vec3[](vec3(-0.57735026919), vec3(-0.57735026919, 0.57735026919, 0.57735026919),
               vec3(0.57735026919, -0.57735026919, 0.57735026919), vec3(0.57735026919, 0.57735026919, -0.57735026919));
    vec2 interval = vec2(-kFar, kFar);
    for (int i = 0; i < 4; ++i) {
        const float away = dot(normal[i], w);
        const float t = (scale / 3 + dot(normal[i], centre)) / (abs(away) < 1e-12 ? 1e-12 : away);
        if (away < 0) interval.x = max(interval.x, t);
        else interval.y = min(interval.y, t);
    }
    return interval;
}

void markSlabs(vec2 view_depths) {
    const vec2 at = slabsAt(view_depths);
    if (!(at.y > 0) || !(at.x < float(grid.slabs))) return;
    const uint from = uint(max(at.x, 0)), to = min(uint(at.y), min(grid.slabs, 32 * kWords) - 1);
    [[unroll]] for (uint w = 0; w < kWords; ++w) {
        const uint lo = max(from, 32 * w), hi = min(to + 1, 32 * w + 32);
        if (lo < hi) bits[w] |= (hi - lo == 32 ? ~0u : ((1u << (hi - lo)) - 1)) << (lo - 32 * w);
    }
}

void gather(inout Pixel pixel, uint slot) {
    const vec3 centre = item[slot].xyz;
    const float scale = item[slot].w, sigma_t = amount[slot].x, radius = amount[slot].y;
    if (kShow == kShowLight) {
        const float depth = -dot(eye.back, centre);
        if (depth < eye.near_depth || depth >= min(pixel.depth, pixel.sum.y)) return;
        const vec3 off = depth * pixel.dir - centre;
        const float away = length(off) / radius;
        const bool rim = away > kRim && radius > 4 * depth * length(eye.ray_down);
        if (away < 1) pixel.sum = vec2(rim ? -1 : sigma_t, depth);
        return;
    }
    const float metres = length(pixel.dir); // per metre of view depth
    const vec3 w = pixel.dir / metres;
    const float closest = dot(centre, w);
    const vec3 beside = centre - closest * w;
    const float b2 = dot(beside, beside), begin = eye.near_depth * metres, end = min(pixel.depth * metres, kFar);
    const float k = gaussianK(scale, tick.falloff);
    if (kShow == kShowDepth) {
        if (end > begin) pixel.sum.x += segmentDepth(sigma_t, k, b2, k * (begin - closest), k * (end - begin));
        return;
    }
    const float chord = sqrt(max(radius * radius - b2, 0));
    vec2 interval = vec2(closest - chord, closest + chord);
    if (isTetrahedron()) {
        if (kTurned)
            interval = inTetrahedron(turnedBack(orientation[slot], w), turnedBack(orientation[slot], centre), scale);
        else interval = inTetrahedron(w, centre, scale);
    }
    interval = vec2(max(interval.x, begin), min(interval.y, end));
    if (!(interval.y > interval.x)) return;
    if (kShow == kShowRays) {
        markSlabs(interval / metres);
        return;
    }
    pixel.sum.x += 1;
    if (kShow == kShowWasted) {
        const float inside = interval.y - interval.x;
        const float depth = kFading ? segmentDepth(sigma_t, k, b2, k * (interval.x - closest), k * inside)
                                    : sigma_t * inside;
        if (depth < leastDepth()) pixel.sum.y += 1;
    }
}

// The optical depth in a texel of the shadow map's planes, which lie side by side above the legend, in rows that begin
// with the plane that is next to the light. < 0: between planes.
float inAtlas(vec2 pixel) {
    const vec2 room = vec2(eye.size) - vec2(0, float((push.legend_size.y + 8) * push.legend_scale));
    if (room.y < 1) return -1; // the legend fills the picture
    const vec2 texels = vec2(tick.map.texels);
    const float count = float(tick.map.slices);
    const float across = clamp(ceil(sqrt(count * room.x * texels.y / (max(room.y, 1) * texels.x))), 1, count);
    const float down = ceil(count / across);
    const float size = min(room.x / (across * (texels.x + 1)), room.y / (down * (texels.y + 1))); // of a texel
    const vec2 at = pixel / size, cell = floor(at / (texels + 1)), texel = at - cell * (texels + 1);
    const float plane = cell.y * across + cell.x;
    if (cell.x >= across || !(plane >= 0) || plane >= count || any(greaterThanEqual(texel, texels))) return -1;
    const float layer = min(floor(plane / 3), float((tick.map.slices - 2) / 3));
    return texelFetch(shadow_volume, ivec3(ivec2(texel), int(layer)), 0)[int(plane - 3 * layer)];
}

// R, G, B and opacity, a byte each.
uint packed(vec3 colour, float opaque_part) { return packUnorm4x8(vec4(colour, opaque_part)); }

uint colourOf(Pixel pixel, vec2 at) {
    const float something = kShow == kShowLight ? float(pixel.sum.y < 1e30) : pixel.sum.x;
    float value = pixel.sum.x;
    if (kShow == kShowOverdraw || kShow == kShowParticles || kShow == kShowDepth) value *= float(push.every);
    if (kShow == kShowShadow) {
        value = tick.particle_count > 0 ? inAtlas(at) : -1;
        return value < 0 ? packed(vec3(0.03), 1) : packed(shownColour(kShow, shownPart(kShow, value)), 1);
    }
    if (kShow == kShowError) {
        const float edge = pixel.sum.y / (kErrorDisc * float(eye.size.y)); // 1 at the disc's rim
        if (edge >= 1) return 0;
        return packed(edge > 0.75 ? vec3(0) : shownColour(kShow, shownPart(kShow, value)), 1);
    }
    if (kShow == kShowLight && value < 0) return packed(vec3(0), 1);
    if (kShow == kShowDepth && value < leastShown(kShow)) return 0;
    if (!(something > 0)) return 0;
    if (kShow == kShowWasted) value = pixel.sum.y / pixel.sum.x;
    return packed(shownColour(kShow, shownPart(kShow, value)), 1);
}

// --- planes ---

// sRGB, 0 ... 255, of the finished picture.
vec3 before(uint from, uvec2 at) {
    const uint block = at.x / 8, n = at.x % 8, word = n / 4;
    vec3 value;
    if (kFull) {
        for (uint c = 0; c < 3; ++c)
            value[c] = float(planes[fullWord(from, c, at.y, block) + word] >> (8 * (n % 4)) & 255u);
        return value;
    }
    const uint chroma = chromaWord(from, at.y / 2, block), shift = 8 * (n / 2);
    value = vec3(planes[lumaWord(from, at.y, block) + word] >> (8 * (n % 4)) & 255u, planes[chroma] >> shift & 255u,
                 planes[chroma + crWords()] >> shift & 255u);
    return rgbOf(value.x, value.y, value.z);
}

// The legend lies in the lower left corner.
vec4 legendAt(uvec2 at) {
    const ivec2 corner = ivec2(4 * push.legend_scale, eye.size.y - (push.legend_size.y + 4) * push.legend_scale);
    const ivec2 from = ivec2(at) - corner;
    if (push.legend_scale == 0 || any(lessThan(from, ivec2(0)))) return vec4(0);
    const uvec2 texel = uvec2(from) / push.legend_scale;
    if (any(greaterThanEqual(texel, push.legend_size))) return vec4(0);
    return unpackUnorm4x8(legends[push.legend + texel.y * push.legend_size.x + texel.x]);
}

const float kDimmed = 0.35;

// sRGB, 0 ... 255. `at` may be beyond the right edge: then it is that of the last column.
vec3 finished(uint from, uvec2 origin, uvec2 at) {
    at = min(at, eye.size - 1);
    const uvec2 square = (at - origin) / push.step, within = (at - origin) % push.step;
    const vec4 shown = unpackUnorm4x8(colours[square.y * kSquares + square.x]);
    vec3 rgb = 255 * shown.rgb;
    if (shown.a < 1) rgb = mix(kDimmed * before(from, at), rgb, shown.a);
    if (kShow == kShowRays && push.step > 2 && shown.a > 0)
        rgb = max(within.x, within.y) < max(push.step / 8, 1) ? mix(rgb, vec3(255), 0.8) : 0.9 * rgb; // the ray itself
    const vec4 legend = legendAt(at);
    return mix(rgb, 255 * legend.rgb, legend.a);
}

// A block of 8x2 pixels, whose words are this lane's alone.
void writeBlock(View view, uvec2 origin, uint block, uint top) {
    const bool odd = top + 1 == eye.size.y; // the last row counts twice
    const uint rows = odd ? 1 : 2;
    vec3 rgb[16];
    [[unroll]] for (uint i = 0; i < 16; ++i)
        rgb[i] = finished(view.planes, origin, uvec2(block * 8 + i % 8, top + i / 8));
    for (uint row = 0; row < rows; ++row)
        [[unroll]] for (uint c = 0; c < 3; ++c) {
            if (kFull ? (tick.channels >> c & 1) == 0 : c > 0) continue;
            uvec2 words = uvec2(0);
            [[unroll]] for (uint i = 0; i < 8; ++i) {
                const vec3 one = row == 0 ? rgb[i] : rgb[8 + i];
                words[i / 4] |= byteOf(kFull ? one[c] : dot(one, kLuma), i);
            }
            uint at = lumaWord(view.planes, top + row, block);
            if (kFull) at = fullWord(view.planes, c, top + row, block);
            planes[at] = words.x;
            planes[at + 1] = words.y;
        }
    if (kFull) return;
    uvec2 chroma = uvec2(0);
    [[unroll]] for (uint i = 0; i < 4; ++i) {
        const vec3 mean = 0.25 * (rgb[2 * i] + rgb[2 * i + 1] + rgb[8 + 2 * i] + rgb[9 + 2 * i]);
        chroma |= uvec2(byteOf(dot(mean, kCb) + 128, i), byteOf(dot(mean, kCr) + 128, i));
    }
    const uint at = chromaWord(view.planes, top / 2, block);
    planes[at] = chroma.x;
    planes[at + crWords()] = chroma.y;
}

void main() {
    tick = tick_block;
    tick.extinction = 1;
    enterView(0);
    const View view = views[0];
    const uint lane = gl_LocalInvocationIndex, side = kSquares * push.step;
    const uvec2 origin = side * uvec2(gl_WorkGroupID.x, view.first / side + gl_WorkGroupID.y);
    const PixelCone cone = pixelCone(origin, origin + side);
    const vec2 middle = vec2(origin) + 0.5 * float(side);
    const uvec2 first = kSide * gl_LocalInvocationID.xy; // of the lane's squares
    [[unroll]] for (uint i = 0; i < kOwn; ++i) {
        const uvec2 at = origin + push.step * (first + uvec2(i % kSide, i / kSide));
        own[i].dir = rayDirection(vec2(at) + (kShow == kShowRays ? 0.5 : 0.5 * float(push.step)));
        own[i].depth = kFar;
        if (kHasOpaque) own[i].depth = texelFetch(view_depth, ivec2(min(at + push.step / 2, eye.size - 1)), 0).r;
        own[i].sum = vec2(0);
        if (kShow == kShowLight || kShow == kShowError) own[i].sum.y = 1e30;
    }
    [[unroll]] for (uint i = 0; i < kWords; ++i) bits[i] = 0;
    PixelCone square = cone; // of kShowParticles: of the lane's own kShowTile x kShowTile pixels
    if (kShow == kShowParticles) {
        const uvec2 corner = origin + kShowTile * (gl_LocalInvocationID.xy / 8);
        square = pixelCone(corner, corner + kShowTile);
    }

    for (uint from = 0; kShow != kShowShadow && from < push.items; from += kLanes) {
        if (lane < kLanes / 32) taken[lane] = 0;
        barrier();
        if (from + lane < push.items && load(from + lane, lane, cone, middle, 0.5 * float(side)))
            atomicOr(taken[lane / 32], 1u << (lane % 32));
        barrier();
        for (uint word = 0; word < kLanes / 32; ++word)
            for (uint left = taken[word]; left != 0; left &= left - 1) {
                const uint slot = 32 * word + uint(findLSB(left));
                if (kShow == kShowParticles) {
                    if (meets(square, item[slot].xyz, amount[slot].y)) own[0].sum.x += 1;
                    continue;
                }
                [[unroll]] for (uint i = 0; i < kOwn; ++i) {
                    if (kShow == kShowError) {
                        const uvec2 at = origin + first + uvec2(i % kSide, i / kSide);
                        const float away = distance(vec2(at) + 0.5, item[slot].xy);
                        if (away < own[i].sum.y) own[i].sum = vec2(item[slot].z, away);
                    } else gather(own[i], slot);
                }
            }
        barrier();
    }

    if (kShow == kShowRays)
        [[unroll]] for (uint i = 0; i < kWords; ++i) own[0].sum.x += float(bitCount(bits[i]));
    [[unroll]] for (uint i = 0; i < kOwn; ++i) {
        const uvec2 square_at = first + uvec2(i % kSide, i / kSide);
        const Pixel pixel = own[kShow == kShowParticles ? 0 : i];
        colours[square_at.y * kSquares + square_at.x] = colourOf(pixel, vec2(origin + push.step * square_at) + 0.5);
    }
    barrier();
    const uint across = side / 8;
    for (uint n = lane; n < across * (side / 2); n += kLanes) {
        const uint block = origin.x / 8 + n % across, top = origin.y + 2 * (n / across);
        if (block * 8 < eye.size.x && top >= view.first && top < view.end) writeBlock(view, origin, block, top);
    }
}
