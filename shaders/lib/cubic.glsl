// Weights of the values at -1, 0, 1, 2 for interpolation between 0 and 1: exact for cubics.
vec4 cubic(float t) {
    return vec4(-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2,
                (t + 1) * t * (t - 1) / 6);
}
