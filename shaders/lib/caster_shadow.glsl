// The interval of a ray in the shadow of an opaque object. A convex object under parallel light has a convex shadow,
// so that there is one interval. Include after lib/objects.glsl.
#include "shaders/blocks/tick.glsl"

// Restricts the range of z to c + z m <= 0.
void bound(inout vec2 range, float c, float m) {
    if (abs(m) < 1e-12) range.y = c > 0 ? -1e30 : range.y;
    else if (m > 0) range.y = min(range.y, -c / m);
    else range.x = max(range.x, -c / m);
}

// The range of z in which `o` hides the light from origin + z dir (x > y: none).
vec2 shadowOf(Opaque o, vec3 origin, vec3 dir) {
    if (o.kind == kPlane) return vec2(1, 0); // a plane is seen and lit from above only
    const vec3 p = origin - o.centre, l = tick.sun.to_light;
    if (o.kind == kSphere) { // the shadow is the sphere and the half cylinder behind it
        const float r2 = o.half_size.x * o.half_size.x;
        const vec3 d_across = dir - dot(dir, l) * l, p_across = p - dot(p, l) * l;
        const float a = max(dot(d_across, d_across), 1e-12), b = dot(d_across, p_across);
        const vec3 off = p_across - (b / a) * d_across;
        const float root = sqrt(max(r2 - dot(off, off), 0) / a);
        vec2 cylinder = vec2(-b / a - root, -b / a + root);
        const float height = dot(p, l), climb = dot(dir, l); // behind: height + z climb < 0
        const float level = -height / (abs(climb) > 1e-12 ? climb : 1e-12);
        if (climb > 0) cylinder.y = min(cylinder.y, level);
        else cylinder.x = max(cylinder.x, level);
        if (dot(off, off) >= r2) return vec2(1, 0);
        const float da = dot(dir, dir), db = dot(dir, p);
        const vec3 nearest = p - (db / da) * dir;
        const float half2 = (r2 - dot(nearest, nearest)) / da;
        if (half2 <= 0) return cylinder;
        const vec2 ball = -db / da + sqrt(half2) * vec2(-1, 1);
        return cylinder.x < cylinder.y ? vec2(min(cylinder.x, ball.x), max(cylinder.y, ball.y)) : ball;
    }
    // A point x is in the box's shadow if x + s l is in the box for some s >= 0. In the box's axes, mirrored so that
    // l >= 0:
    // -half <= x_i + s l_i <= half. Eliminating s leaves one line for every pair of a lower and an upper bound.
    vec3 d = toObject(o, dir), x = toObject(o, p), w = toObject(o, l);
    const vec3 mirror = mix(vec3(1), vec3(-1), lessThan(w, vec3(0)));
    d *= mirror;
    x *= mirror;
    w *= mirror;
    vec2 range = vec2(-1e30, 1e30);
    for (int i = 0; i < 3; ++i) {
        // 0 <= upper_i, and lower_j <= upper_i: c + z m <= 0
        for (int j = -1; j < 3; ++j) {
            if (j == i) continue;
            const float wj = j < 0 ? 1 : w[j];
            const float c =
                j < 0 ? x[i] - o.half_size[i] : (x[i] - o.half_size[i]) * wj - (x[j] + o.half_size[j]) * w[i];
            const float m = j < 0 ? d[i] : d[i] * wj - d[j] * w[i];
            bound(range, c, m);
        }
        if (w[i] < 1e-6) bound(range, -x[i] - o.half_size[i], -d[i]); // l_i is 0: -half <= x_i
    }
    return range;
}
