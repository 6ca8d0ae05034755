// Casters whose shadow rays may meet. Include after the tick, lib/view.glsl, lib/eye.glsl, `objects` and
// lib/objects.glsl.
#include "shaders/lib/caster_shadow.glsl"

const uint kFurther = 1u << 31; // bit of castersMet() for all casters after the first 31

// Bits of casters whose shadow in the slabs a ray may meet that is at most `radius` pixels from `middle`. If it does,
// the middle ray meets the shadow of a caster that is larger by the distance between the two.
uint castersMet(vec2 middle, float radius) {
    const vec3 dir = rayDirection(middle);
    const float pixel = max(length(eye.ray_right), length(eye.ray_down));
    const float apart = 1.001 * farDepth() * radius * pixel; // m, at most
    uint met = 0;
    for (uint o = grid.first_caster; o < min(tick.opaque_count, grid.first_caster + 31); ++o) {
        Opaque caster = objects[o];
        caster.half_size = 1.001 * caster.half_size + apart;
        const vec2 range = shadowOf(caster, eye.position, dir);
        if (max(range.x, grid.depth) <= min(range.y, farDepth())) met |= 1u << (o - grid.first_caster);
    }
    return tick.opaque_count > grid.first_caster + 31 ? met | kFurther : met;
}
