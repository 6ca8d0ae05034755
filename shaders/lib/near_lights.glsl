// The part of a light that nodes keep at a distance from it; the rest is added exactly (shared/lit_grid.h).
float keptPart(float distance) {
    const float near = push.lit.near;
    return near > 0 ? smoothstep(near, 2 * near, distance / push.lit.spacing) : 1;
}
