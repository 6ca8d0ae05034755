// Casters whose shadow rays may meet. Include after the tick, lib/view.glsl, lib/eye.glsl, `objects` and
// lib/objects.glsl.
#include "shaders/lib/caster_shadow.glsl"

const uint kFurther = 1u << 31; // bit of castersMet() for all casters after the first 31

// Bits of casters whose shadow between two view depths a ray may meet that is at most `radius` pixels from `middle`. If
// it does, the middle ray meets the shadow of a caster that is larger by the distance between the two.
uint castersMet(vec2 middle, float radius, float from, float to) {
    const vec3 dir = rayDirection(middle);
    const float pixel = max(length(eye.ray_right), length(eye.ray_down));
    const float apart = 1.001 * to * radius * pixel; // m, at most
    uint met = 0;
    for (uint o = grid.first_caster; o < min(tick.opaque_count, grid.first_caster + 31); ++o) {
        Opaque caster = objects[o];
        caster.half_size = 1.001 * caster.half_size + apart;
        const vec2 range = shadowOf(caster, eye.position, dir);
        if (max(range.x, from) <= min(range.y, to)) met |= 1u << (o - grid.first_caster);
    }
    return tick.opaque_count > grid.first_caster + 31 ? met | kFurther : met;
}

// The same in all of the medium before view depth `far`. Fog reaches far, and is taken piece by piece, since rays are
// the more apart the farther away.
uint castersMet(vec2 middle, float radius, float far) {
    if (!kHasFog) return castersMet(middle, radius, grid.depth, farDepth());
    const float end = min(far, faceDepth(lastFace()));
    uint met = 0;
    for (float from = eye.near_depth; from < end;) {
        const float to = min(max(10 * from, 10), end);
        met |= castersMet(middle, radius, from, to);
        from = to;
    }
    return met;
}
