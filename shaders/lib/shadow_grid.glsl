// Looks up light past objects in the shared shadow grid. Include after shared/shadow_grid.h, and these are declared:
//   ShadowGridBlock shadow_grid, in a uniform block
//   uint shadow_voxels[]: four bytes each. A brick's voxels follow each other, [z][y][x], and so do bricks.

uint shadowBrickAt(uvec3 brick) {
    return (brick.z * shadow_grid.bricks.y + brick.y) * shadow_grid.bricks.x + brick.x;
}
// Index of a voxel, in voxels.
uint shadowVoxelAt(uvec3 voxel) {
    const uvec3 local = voxel % kShadowBrick;
    return 512 * shadowBrickAt(voxel / kShadowBrick) + (local.z * kShadowBrick + local.y) * kShadowBrick + local.x;
}
// The lit part of a voxel in units of kLitVoxel, or kSolidVoxel.
uint shadowVoxel(uint slot, uvec3 voxel) {
    const uint at = shadowVoxelAt(voxel);
    if (shadow_grid.coverage == 0)
        return (shadow_voxels[at / 4] >> (8 * (at & 3) + slot) & 1) * kLitVoxel;
    return shadow_voxels[at * (shadow_grid.stride / 4) + slot / 4] >> (8 * (slot & 3)) & 255;
}

// The part of a light that arrives at x past objects. `known`: false outside the grid. With coverage, voxels in
// solids leave the interpolation; where there are no others, it is dark. Bits of voxels in solids are dark.
float litInGrid(uint slot, vec3 x, out bool known) {
    const vec3 at = (x - shadow_grid.origin) / shadow_grid.voxel, size = vec3(shadow_grid.bricks * kShadowBrick);
    known = slot < kMostShadowSlots && all(greaterThanEqual(at, vec3(0))) && all(lessThan(at, size));
    if (!known) return 0;
    const uvec3 last = shadow_grid.bricks * kShadowBrick - 1;
    if (shadow_grid.linear == 0) {
        const uint value = shadowVoxel(slot, min(uvec3(at), last));
        return value == kSolidVoxel ? 0 : float(value) / float(kLitVoxel);
    }
    const vec3 from_middle = max(at - 0.5, 0), first = floor(from_middle), part = from_middle - first;
    const uvec3 lo = min(uvec3(first), last), hi = min(lo + 1, last);
    float sum = 0, weights = 0;
    [[dont_unroll]] for (uint i = 0; i < 8; ++i) {
        const bvec3 upper = bvec3((i & 1) != 0, (i & 2) != 0, (i & 4) != 0);
        const vec3 w = mix(1 - part, part, upper);
        const uint value = shadowVoxel(slot, mix(lo, hi, upper));
        const float weight = value == kSolidVoxel ? 0 : w.x * w.y * w.z;
        sum += weight * float(value);
        weights += weight;
    }
    return weights > 0 ? sum / (weights * float(kLitVoxel)) : 0;
}
