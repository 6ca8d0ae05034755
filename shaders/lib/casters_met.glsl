// Objects whose shadows rays may meet. Include after lib/view.glsl, lib/eye.glsl and
// lib/objects.glsl.
#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/tick.glsl"
#include "shaders/lib/caster_shadow.glsl"

const float kMostPiece = 3; // most that a piece's far end is from the eye, as a multiple of its near end's distance

// Rays through the pixels that are at most some pixels from a middle one: a cone around its ray.
struct RayCone {
    vec3 dir;     // of unit view depth
    float spread; // m of radius per m of view depth
};

RayCone rayCone(vec2 middle, float radius) {
    return RayCone(rayDirection(middle), 1.001 * radius * max(length(eye.ray_right), length(eye.ray_down)));
}

// The view depths between which the cone may meet the shadow of a ball of the radius `r` around `centre`; x > y: none.
// The shadow is taken as a half cylinder that begins r before the ball's middle.
vec2 shadowOfBall(RayCone cone, vec3 centre, float r, vec2 range) {
    const vec3 l = tick.sun.to_light, from = eye.position - centre;
    const float along = dot(from, l), climb = dot(cone.dir, l);
    // Height above the ball's middle: along + z climb <= r + z spread.
    const float slope = climb - cone.spread, above = along - r;
    if (abs(slope) < 1e-12) range.y = above > 0 ? -1 : range.y;
    else if (slope > 0) range.y = min(range.y, -above / slope);
    else range.x = max(range.x, -above / slope);
    // Distance from the axis: |p + z d| <= r + z spread.
    const vec3 p = from - along * l, d = cone.dir - climb * l;
    const float a = dot(d, d) - cone.spread * cone.spread, b = dot(p, d) - r * cone.spread, c = dot(p, p) - r * r;
    if (a < 1e-9 * dot(cone.dir, cone.dir)) return range; // along the light: it may meet it anywhere
    const float root2 = b * b * 1.000001 - a * c; // larger by what rounding may take away
    if (root2 < 0) return vec2(1, 0);
    const float root = sqrt(root2);
    return vec2(max(range.x, (-b - root) / a), min(range.y, (root - b) / a));
}

// The view depth at which a ray of the cone may meet the shadow of object `o` first, of those between two; kMiss: none
// does. If one does, the middle ray meets the shadow of an object that is larger by the distance between the two.
float meetsShadow(uint o, RayCone cone, vec2 range) {
    Opaque caster = objects[o];
    const float r = caster.kind == kSphere ? caster.half_size.x : length(caster.half_size);
    range = shadowOfBall(cone, caster.centre, 1.001 * r, range);
    if (!(range.x <= range.y)) return kMiss;
    const vec3 half_size = 1.001 * caster.half_size;
    for (float from = range.x; from < range.y;) { // piece by piece, since rays are the more apart the farther away
        const float to = min(max(kMostPiece * from, 1), range.y);
        caster.half_size = half_size + to * cone.spread;
        const vec2 shadow = shadowOf(caster, eye.position, cone.dir);
        if (max(shadow.x, from) <= min(shadow.y, to)) return max(shadow.x, from);
        from = to;
    }
    return kMiss;
}

// The view depths of the medium before view depth `far`.
vec2 mediumBefore(float far) {
    return kHasFog ? vec2(eye.near_depth, min(far, faceDepth(lastFace()))) : vec2(grid.depth, min(far, farDepth()));
}
