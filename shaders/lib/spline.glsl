// Cubic B-spline: weights of the coefficients at -1, 0, 1, 2 for 0 <= t < 1.
vec4 spline(float t) {
    const float r = 1 - t;
    return vec4(r * r * r, (3 * t - 6) * t * t + 4, (3 * r - 6) * r * r + 4, t * t * t) * (1.0 / 6.0);
}
