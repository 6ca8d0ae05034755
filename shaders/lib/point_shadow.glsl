// The interval of a ray in the shadow of an opaque object or a triangle under a local light. What a convex object hides from a point
// is convex, so that there is one interval. Include after lib/objects.glsl.

const vec2 kAllHidden = vec2(-1e30, 1e30), kNoneHidden = vec2(1, 0);

// Restricts the range of t to c + t m <= 0.
void cutTo(inout vec2 range, float c, float m) {
    if (abs(m) < 1e-12) range.y = c > 0 ? -1e30 : range.y;
    else if (m > 0) range.y = min(range.y, -c / m);
    else range.x = max(range.x, -c / m);
}

// The range of t in which offset + t w lies within a cone about `axis`, x > y: nowhere. `offset`: perpendicular to the
// unit vector w, from the cone's tip; cosine: of the angle between axis and cone, above 0.
vec2 insideCone(vec3 axis, float cosine, vec3 offset, vec3 w) {
    const float along = dot(w, axis), off = dot(offset, axis), square = cosine * cosine;
    const float a = along * along - square, b = along * off, c = off * off - square * dot(offset, offset);
    const float root = b * b - a * c;
    if (abs(a) < 1e-7) { // the ray goes along the cone's side: one end
        if (abs(b) < 1e-20) return off > 0 ? kAllHidden : kNoneHidden;
        const float end = -0.5 * c / b;
        return along > 0 ? vec2(end, 1e30) : vec2(-1e30, end);
    }
    if (a < 0) {
        if (root <= 0) return kNoneHidden;
        const vec2 ends = (-b + sqrt(root) * vec2(1, -1)) / a;
        return off + 0.5 * (ends.x + ends.y) * along > 0 ? ends : kNoneHidden;
    }
    const float far = sqrt(max(root, 0));
    return along > 0 ? vec2((-b + far) / a, 1e30) : vec2(-1e30, (-b - far) / a);
}

// The range of t in which `o` hides the light from light + offset + t w (x > y: none). `offset`: perpendicular to the
// unit vector w.
vec2 hiddenFrom(Opaque o, vec3 light, vec3 offset, vec3 w) {
    if (o.kind == kPlane) { // it hides what is below it from places above it
        vec2 above = light.y < o.centre.y ? kAllHidden : kNoneHidden;
        cutTo(above, o.centre.y - light.y - offset.y, -w.y);
        return above;
    }
    const vec3 to = o.centre - light;
    if (o.kind == kSphere) { // the ball, and what lies behind it in the cone that touches it
        const float r2 = o.half_size.x * o.half_size.x, square = dot(to, to);
        if (square <= r2) return kAllHidden;
        const float distance = sqrt(square), along = dot(to, w);
        vec2 cone = insideCone(to / distance, sqrt(1 - r2 / square), offset, w);
        // Behind the circle of touch: (offset + t w) . to >= square - r2.
        cutTo(cone, square - r2 - dot(offset, to), -along);
        const vec3 nearest = offset + along * w - to;
        const float half2 = r2 - dot(nearest, nearest);
        if (half2 <= 0) return cone;
        const vec2 ball = along + sqrt(half2) * vec2(-1, 1);
        return cone.x < cone.y ? vec2(min(cone.x, ball.x), max(cone.y, ball.y)) : ball;
    }
    // The place y, from the light in the box's axes, is hidden if y / s is in the box for some s >= 1. So
    // s lo <= y <= s hi, mirrored so that hi > 0. Where lo < 0, both are lower bounds of s. Else y / lo is an upper
    // one. Eliminating s leaves one line for every pair of a lower and an upper bound.
    vec3 y = toObject(o, offset), d = toObject(o, w), lo = toObject(o, to) - o.half_size,
         hi = toObject(o, to) + o.half_size;
    for (int i = 0; i < 3; ++i)
        if (hi[i] <= 0) {
            const float less = -hi[i];
            hi[i] = -lo[i];
            lo[i] = less;
            y[i] = -y[i];
            d[i] = -d[i];
        }
    vec2 range = kAllHidden;
    for (int i = 0; i < 3; ++i) {
        if (lo[i] < 0) continue;
        cutTo(range, lo[i] - y[i], -d[i]); // 1 <= y_i / lo_i
        for (int j = 0; j < 3; ++j) {
            if (j == i) continue;
            cutTo(range, y[j] * lo[i] - y[i] * hi[j], d[j] * lo[i] - d[i] * hi[j]);
            if (lo[j] < 0) cutTo(range, -y[j] * lo[i] + y[i] * lo[j], -d[j] * lo[i] + d[i] * lo[j]);
        }
    }
    return range;
}

// The same of a triangle: what is behind it, between the planes through the light and its edges.
vec2 hiddenFrom(Triangle triangle, vec3 light, vec3 offset, vec3 w) {
    const vec3 a = triangle.a - light, b = triangle.b - light, c = triangle.c - light;
    const vec3 normal = cross(b - a, c - a);
    const float volume = dot(normal, a);
    if (volume == 0) return kNoneHidden; // the light sees its side
    const vec3 sides[4] = vec3[](normal, cross(a, b - a), cross(b, c - b), cross(c, a - c));
    vec2 range = kAllHidden;
    for (int i = 0; i < 4; ++i) {
        const vec3 inward = volume > 0 ? sides[i] : -sides[i];
        // inward . (offset + t w) >= |volume| behind the triangle, >= 0 at the other three.
        cutTo(range, (i == 0 ? abs(volume) : 0) - dot(inward, offset), -dot(inward, w));
    }
    return range;
}
