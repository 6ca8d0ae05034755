// The parts of a ray in the sun's shadow of meshes, by the height map of meshes under the sun: texel after texel, and
// over many at once where the pyramid tells that all are in the shadow or none. Include after
// lib/shadow_list.glsl, and what lib/mesh_pyramid.glsl needs is declared.
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/has_meshes.glsl"
#include "shaders/lib/mesh_pyramid.glsl"

const uint kMostMeshSteps = 4096;

// Adds the parts of origin + t dir, t in begin ... end, that the meshes keep the sun from.
void walkShadowMap(vec3 origin, vec3 dir, float begin, float end) {
    const vec2 per_metre = float(tick.mesh_size) / (tick.mesh_hi - tick.mesh_lo);
    const vec3 sun = tick.sun.to_light;
    // In texels and m along the sun's light.
    const vec3 o = vec3((vec2(dot(tick.map.x, origin), dot(tick.map.y, origin)) - tick.mesh_lo) * per_metre,
                        dot(sun, origin));
    vec3 d = vec3(vec2(dot(tick.map.x, dir), dot(tick.map.y, dir)) * per_metre, dot(sun, dir));
    d.xy = mix(d.xy, vec2(1e-12), lessThan(abs(d.xy), vec2(1e-12)));
    // Above the map, beside it and above all heights there is no shadow.
    const vec2 a = -o.xy / d.xy, b = (float(tick.mesh_size) - o.xy) / d.xy;
    const vec2 enter = min(a, b), leave = max(a, b);
    float at = max(begin, max(enter.x, enter.y));
    end = min(end, min(leave.x, leave.y));
    const uint top = uint(findMSB(tick.mesh_size));
    const float nudge = 1e-3 / max(abs(d.x), abs(d.y)); // a thousandth of a texel
    float open = 1e30; // where the present shadow began
    uint level = top;
    [[dont_unroll]] for (uint step = 0; step < kMostMeshSteps && at < end; ++step) {
        const vec2 place = o.xy + (at + nudge) * d.xy;
        const float size = float(1u << level);
        const ivec2 square = ivec2(floor(place / size));
        const vec2 wall = (vec2(square) + vec2(greaterThan(d.xy, vec2(0)))) * size;
        const vec2 out_of = (wall - o.xy) / d.xy;
        const float next = min(max(min(out_of.x, out_of.y), at + nudge), end);
        const vec2 heights = meshHeights(level, square);
        const float here = o.z + at * d.z, there = o.z + next * d.z;
        const bool lit = min(here, there) >= heights.y, dark = max(here, there) < heights.x;
        if (!lit && !dark && level > 0) {
            --level;
            continue;
        }
        const bool dark_here = dark || (!lit && here < heights.x), dark_there = dark || (!lit && there < heights.x);
        const float crossing = dark_here == dark_there ? at : clamp((heights.x - o.z) / d.z, at, next);
        if (dark_here && open == 1e30) open = at;
        if (!dark_here && open != 1e30) {
            joinShadow(vec2(open, at), 0);
            open = 1e30;
        }
        if (dark_here && !dark_there) {
            joinShadow(vec2(open, crossing), 0);
            open = 1e30;
        }
        if (!dark_here && dark_there) open = crossing;
        at = next;
        // The next larger square has neither all in the shadow nor none, or else it would have been taken.
        const ivec2 ahead = ivec2(floor((o.xy + (at + nudge) * d.xy) / size));
        if (any(notEqual(ahead >> 1, square >> 1))) level = min(level + 1, top);
    }
    if (open < end) joinShadow(vec2(open, end), 0);
}
