// Light depth at a place in a tetrahedron: from the shadow map where it can tell, and else by a walk to the light. The
// map is linear between its texels and planes. Where the medium begins within one, as at a hard outside, that is wrong.
// Include after lib/light.glsl, lib/tetrahedra.glsl and these push constants are declared:
//   uint faces     of the outside
//   float agrees   optical depth that the map's numbers may differ by
#include "shaders/blocks/shadow_volume.glsl"
#include "shaders/blocks/tick.glsl"

const float kDark = 12; // optical depth from which on no light is seen

// Places `walk` at a place of the line in a tetrahedron, at t = 0, where the extinction is sigma. False: the line does
// not go through it, as far as roundings tell.
bool beginWithin(out Walk walk, Line line, uint cell, float sigma) {
    const uvec4 corners = cells[cell].corners;
    bool met = false;
    [[dont_unroll]] for (uint m = 0; m < 4 && !met; ++m) {
        const uvec3 face = m == 0 ? corners.yzw : m == 1 ? corners.xwz : m == 2 ? corners.xyw : corners.xzy;
        met = meetFace(walk, line, face, cell);
    }
    walk.placed = true;
    walk.t = 0;
    walk.sigma = sigma;
    return met;
}

// Optical depth between such a place and the light, without tick.extinction. It ends where no light is left.
float walkedLightDepth(Walk walk, Line line) {
    const float dark = kDark / max(tick.extinction, 1e-30);
    float depth = 0;
    Entry entered = Entry(0, 0);
    bool inside = true;
    [[dont_unroll]] while (inside) {
        [[dont_unroll]] for (uint n = 0; walk.cell != kNoTetrahedron && depth < dark && n < cells.length(); ++n) {
            const bool placed = walk.placed;
            const float t = walk.t, sigma = walk.sigma;
            passTetrahedron(walk, line);
            if (placed) depth += linearDepth(sigma, walk.sigma, walk.t - t);
        }
        if (!(depth < dark)) break;
        inside = enterAgain(walk, line, push.faces, entered, kEndless);
    }
    return depth;
}

// A place in the shadow map, between two planes of a layer of four.
struct MapPlace {
    vec2 at; // texture coordinates
    float layer;
    uint plane; // the layer's plane before the place: 0 ... 2
    float part; // of the way from it to the next plane, 0 ... 1
};

// Depths at the two planes around, without tick.extinction, `aside` texels away.
vec2 depthsAt(MapPlace place, vec2 aside) {
    const vec4 depths = textureLod(shadow_volume, vec3(place.at + aside / vec2(tick.map.texels), place.layer), 0);
    return place.plane == 0 ? depths.xy : place.plane == 1 ? depths.yz : depths.zw;
}

// Optical depth between the light and a place in a tetrahedron, where the extinction is sigma. in_volume: the place in
// the shadow map. The map tells it if the medium is as dense between its planes as at the place, and if its depths are
// linear from texel to texel.
float lightDepthWithin(uint cell, vec3 place, vec3 in_volume, float sigma) {
    const float plane = clamp(in_volume.z, 0, float(tick.map.slices - 1));
    const float layer = min(floor(plane * 0.333333343), float((tick.map.slices - 2) / 3));
    const float first = min(floor(plane - 3 * layer), 2);
    const MapPlace in_map = MapPlace(in_volume.xy, layer, uint(first), plane - 3 * layer - first);
    const vec2 depths = depthsAt(in_map, vec2(0));
    const float depth = mix(depths.x, depths.y, in_map.part);
    const vec3 size = tick.map.hi - tick.map.lo;
    const float step = size.z / float(tick.map.slices - 1);
    const float cube = sigma * max(step, max(size.x / float(tick.map.texels.x), size.y / float(tick.map.texels.y)));
    // The depth that texels beside the place lack is taken to be at most 8 cubes': then there is no light either.
    const bool dark = tick.extinction * (depths.x - 8 * cube) > kDark;
    if (dark || tick.extinction * cube < push.agrees) return tick.extinction * depth;
    float off = abs(sigma * step - (depths.y - depths.x));
    [[unroll]] for (int axis = 0; axis < 2; ++axis) {
        const vec2 aside = axis == 0 ? vec2(1, 0) : vec2(0, 1);
        const vec2 bent = depthsAt(in_map, aside) + depthsAt(in_map, -aside) - 2 * depths;
        off = max(off, 0.5 * abs(mix(bent.x, bent.y, in_map.part)));
    }
    if (tick.extinction * off > push.agrees) {
        const Line line = lineOf(place, tick.sun.to_light);
        Walk walk;
        if (beginWithin(walk, line, cell, sigma)) return tick.extinction * walkedLightDepth(walk, line);
    }
    return tick.extinction * depth;
}
