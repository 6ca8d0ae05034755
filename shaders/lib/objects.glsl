// Intersections of rays with opaque objects.

// Rotates a vector into an object's own axes (yaw about +Y).
vec3 toObject(Opaque o, vec3 v) {
    return vec3(o.yaw_cos * v.x - o.yaw_sin * v.z, v.y, o.yaw_sin * v.x + o.yaw_cos * v.z);
}
vec3 fromObject(Opaque o, vec3 v) {
    return vec3(o.yaw_cos * v.x + o.yaw_sin * v.z, v.y, -o.yaw_sin * v.x + o.yaw_cos * v.z);
}

const float kMiss = 1e30; // also the view depth of the sky

// Distance along the ray origin + t dir (in units of dir) to object `o`; kMiss if it is not hit at t > 0; `n`: unit
// normal there.
float hitObject(Opaque o, vec3 origin, vec3 dir, out vec3 n) {
    n = vec3(0, 1, 0);
    if (o.kind == kPlane) {
        const float t = (o.centre.y - origin.y) / dir.y;
        return dir.y < 0 && t > 0 ? t : kMiss;
    }
    if (o.kind == kSphere) { // distance to the closest point first: no cancellation far away
        const float inv = inversesqrt(dot(dir, dir));
        const vec3 w = dir * inv, oc = o.centre - origin;
        const float along = dot(oc, w);
        const vec3 off = oc - along * w;
        const float half_squared = o.half_size.x * o.half_size.x - dot(off, off);
        const float t = along - sqrt(max(half_squared, 0));
        n = (t * w - oc) / o.half_size.x;
        return half_squared > 0 && t > 0 ? t * inv : kMiss;
    }
    const vec3 d = toObject(o, dir), p = toObject(o, origin - o.centre);
    const vec3 inv = 1 / mix(d, vec3(1e-12), lessThan(abs(d), vec3(1e-12)));
    const vec3 a = (-o.half_size - p) * inv, b = (o.half_size - p) * inv;
    const vec3 t0 = min(a, b), t1 = max(a, b);
    const float enter = max(t0.x, max(t0.y, t0.z)), leave = min(t1.x, min(t1.y, t1.z));
    n = fromObject(o, -sign(d) * vec3(greaterThanEqual(t0, vec3(enter))));
    return enter < leave && enter > 0 ? enter : kMiss;
}
