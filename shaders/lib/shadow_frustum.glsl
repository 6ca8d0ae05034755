// Looks up light past objects in an eye's shadow frustum. Include after shared/shadow_frustum.h, and these are
// declared:
//   ShadowFrustum shadow_frusta[]: one for each eye
//   uint shadow_froxels[]: four froxels each

// True if the slot's light reaches the froxel that holds this place in the picture. Places beyond the picture take the
// froxel at its rim. `slice`: less than shadow_frusta[view].slices.
bool litInFrustum(uint view, uint slot, uvec2 pixel, uint slice) {
    const uint columns = shadow_frusta[view].columns, rows = shadow_frusta[view].rows;
    const uvec2 froxel = min(pixel, shadow_frusta[view].eye.size - 1) / shadow_frusta[view].pixels;
    const uint at = (slice * rows + froxel.y) * columns + froxel.x;
    return (shadow_froxels[shadow_frusta[view].first + at / 4] >> (8 * (at & 3) + slot) & 1) != 0;
}
