// Objects whose shadow rays may meet. Include after the tick, lib/view.glsl, lib/eye.glsl, `objects` and
// lib/objects.glsl.
#include "shaders/lib/caster_shadow.glsl"

// True if between two view depths a ray may meet the shadow of object `o` that is at most `radius` pixels from
// `middle`. If it does, the middle ray meets the shadow of an object that is larger by the distance between the two.
bool meetsShadow(uint o, vec2 middle, float radius, float from, float to) {
    const float pixel = max(length(eye.ray_right), length(eye.ray_down));
    const float apart = 1.001 * to * radius * pixel; // m, at most
    Opaque caster = objects[o];
    caster.half_size = 1.001 * caster.half_size + apart;
    const vec2 range = shadowOf(caster, eye.position, rayDirection(middle));
    return max(range.x, from) <= min(range.y, to);
}

// The same in all of the medium before view depth `far`. Fog reaches far, and is taken piece by piece, since rays are
// the more apart the farther away.
bool meetsShadow(uint o, vec2 middle, float radius, float far) {
    if (!kHasFog) return meetsShadow(o, middle, radius, grid.depth, farDepth());
    const float end = min(far, faceDepth(lastFace()));
    for (float from = eye.near_depth; from < end;) {
        const float to = min(max(10 * from, 10), end);
        if (meetsShadow(o, middle, radius, from, to)) return true;
        from = to;
    }
    return false;
}
