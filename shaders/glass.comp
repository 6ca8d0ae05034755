#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Sheets of glass, per eye, between the passes that draw the medium: adds the layer that the target holds to each
// pixel's sum, and sets the target up for the next one. The first layer is the whole medium before surfaces; layer i
// ends at the i-th nearest sheet before these (shared/glass.h). A lane is a pixel.
#include "shaders/shared/types.h"
#include "shaders/shared/glass.h"

layout(local_size_x = 8, local_size_y = 8) in;

struct GlassSum {
    vec3 radiance;       // of the layers that were drawn
    float transmittance; // of the whole medium
    float depth;         // m, of view depth: of the surface
};

#include "shaders/blocks/eye.glsl"
layout(rgba32f) uniform image2D radiance;
layout(r32f) uniform image2D view_depth;
layout(scalar) readonly buffer Sheets { GlassSheet sheets[]; };
layout(scalar) buffer Sums { GlassSum sums[]; }; // row by row
layout(push_constant, scalar) uniform Push { GlassPush push; };

#include "shaders/lib/eye.glsl"
#include "shaders/lib/sky.glsl"

// Of the pixel, the nearest sheet first.
uint sheet_count;
float sheet_depth[kGlassLayers]; // m of view depth
vec3 sheet_passes[kGlassLayers], sheet_mirrored[kGlassLayers];

// The number t of glassAt() for the ray through a position of the picture.
float meets(GlassSheet s, vec2 at) {
    return glassAt(s.centre - eye.position, s.across, s.along, s.normal, rayDirection(at));
}

void insert(float depth, vec3 passes, vec3 mirrored) {
    for (uint i = 0; i < sheet_count; ++i) {
        if (depth >= sheet_depth[i]) continue;
        const float farther = sheet_depth[i];
        const vec3 t = sheet_passes[i], r = sheet_mirrored[i];
        sheet_depth[i] = depth, sheet_passes[i] = passes, sheet_mirrored[i] = mirrored;
        depth = farther, passes = t, mirrored = r;
    }
    if (sheet_count == kGlassLayers) return;
    sheet_depth[sheet_count] = depth;
    sheet_passes[sheet_count] = passes;
    sheet_mirrored[sheet_count++] = mirrored;
}

// Sheets before view depth `end`. At its edges a sheet covers a part of the pixel, by the rays that smooth the edges of
// objects (lib/background.glsl).
void findSheets(vec2 centre, float end) {
    const vec2 offsets[4] = vec2[](vec2(-0.375, -0.125), vec2(0.125, -0.375), vec2(0.375, 0.125), vec2(-0.125, 0.375));
    const vec3 dir = rayDirection(centre), w = normalize(dir);
    sheet_count = 0;
    for (uint n = 0; n < push.sheets; ++n) {
        const GlassSheet s = sheets[n];
        float depth = meets(s, centre), part = 0;
        const bool middle = depth > 0;
        for (uint i = 0; i < 4; ++i) {
            const float there = meets(s, centre + offsets[i]);
            if (!(there > 0)) continue;
            part += 0.25;
            if (!middle) depth = there;
        }
        if (part == 0 || !(depth >= eye.near_depth && depth < end)) continue;
        const float mirrors = glassMirrors(s.reflectance, dot(w, s.normal));
        insert(depth, mix(vec3(1), s.transmittance * (1 - mirrors), part),
               part * mirrors * skyRadiance(reflect(w, s.normal)));
    }
}

void main() {
    const uvec2 at = gl_GlobalInvocationID.xy + uvec2(0, push.first);
    if (at.x >= eye.size.x || at.y >= min(push.end, eye.size.y)) return;
    const ivec2 pixel = ivec2(at);
    const uint index = at.y * eye.size.x + at.x;
    const vec4 layer = imageLoad(radiance, pixel);
    GlassSum sum;
    if (push.drawn == 0) sum = GlassSum(vec3(0), layer.a, imageLoad(view_depth, pixel).r);
    else sum = sums[index];
    findSheets(vec2(at) + 0.5, sum.depth);
    vec3 passed = vec3(1); // by the sheets before where the layer ends
    for (uint i = 0; i < sheet_count && (push.drawn == 0 || i + 1 < push.drawn); ++i) passed *= sheet_passes[i];
    if (push.drawn == 0) sum.radiance = passed * layer.rgb;
    else if (push.drawn <= sheet_count) {
        const uint i = push.drawn - 1;
        sum.radiance += passed * ((1 - sheet_passes[i]) * layer.rgb + layer.a * sheet_mirrored[i]);
    }
    if (push.drawn < push.layers) {
        // Without a sheet all of the pixel's medium is behind the near plane.
        const float end = push.drawn < sheet_count ? sheet_depth[push.drawn] : eye.near_depth;
        imageStore(view_depth, pixel, vec4(end));
        imageStore(radiance, pixel, vec4(0, 0, 0, 1));
        sums[index] = sum;
    } else {
        imageStore(view_depth, pixel, vec4(sum.depth));
        imageStore(radiance, pixel, vec4(sum.radiance, sum.transmittance));
    }
}
