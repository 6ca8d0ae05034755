// Where slabs lie along a ray: view depths (m) of their faces and middles, and the face of a view depth. Only this file
// knows how thick slabs are. The slabs that particles are added to are equally thick. With fog there are more before
// and behind them, which grow with their distance from the particles:
//
//   eye  |        front         |   |  |||||||||||||||||||||||  |   |         back          |        the rest
//                                      particles: grid.slabs
//
// "Slab" counts from the particles' first one, "face" and "fog slab" from the first of all. Face f is the near one of
// fog slab f. Without fog the two are the same. Include after `eye` and `grid` are declared.
#include "shaders/lib/has_fog.glsl"

// Slabs of particles.
float slabThickness() { return grid.thickness; }
float middleDepth(uint slab) { return grid.depth + (float(slab) + 0.5) * grid.thickness; }
float farDepth() { return grid.depth + grid.thickness * float(grid.slabs); } // where the last one ends
vec2 slabsAt(vec2 depths) { return (depths - grid.depth) / grid.thickness; } // and parts of one; not clamped
// Sheets of grid.sheet slabs, and parts of one.
float sheetAt(float depth) {
    const float sheet = grid.thickness * float(grid.sheet);
    return (depth - grid.depth) / sheet;
}

// All slabs. The last face is the far one of the last.
uint frontSlabs() { return kHasFog ? grid.front : 0; }
uint lastFace() { return kHasFog ? grid.front + grid.slabs + grid.back : grid.slabs; }

// Thickness of `count` growing slabs together, in units of kFogGrowth's first.
float grown(float count) { return exp2(kLogFogGrowth * count) - 1; }
float grownCount(float thickness) { return log2(1 + max(thickness, 0)) * (1 / kLogFogGrowth); }

// Of a face, or of a part of a slab.
float faceDepth(float face) {
    if (!kHasFog) return grid.depth + face * grid.thickness;
    const float slab = face - float(grid.front), behind = slab - float(grid.slabs);
    if (slab < 0) return max(grid.depth - grid.front_unit * grown(-slab), eye.near_depth);
    return behind > 0 ? farDepth() + grid.back_unit * grown(behind) : grid.depth + slab * grid.thickness;
}
float faceDepth(uint face) { return faceDepth(float(face)); }
// Faces and parts of a slab; not clamped.
float faceAt(float depth) {
    if (!kHasFog) return (depth - grid.depth) / grid.thickness;
    const float front = float(grid.front), far = farDepth();
    if (depth < grid.depth)
        return grid.front == 0 ? 0 : front - grownCount((grid.depth - depth) / grid.front_unit);
    if (depth > far) return front + float(grid.slabs) + grownCount((depth - far) / grid.back_unit);
    return front + (depth - grid.depth) / grid.thickness;
}
vec2 facesAt(vec2 depths) {
    if (!kHasFog) return (depths - grid.depth) / grid.thickness;
    return vec2(faceAt(depths.x), faceAt(depths.y));
}
// Slabs behind a face whose medium the march up to it reads (lib/slab_march.glsl).
const uint kSlabsAhead = 2;
// True: particles are added to none of the fog slab.
bool isFogAlone(uint fog_slab) {
    return kHasFog && (fog_slab < grid.front || fog_slab >= grid.front + grid.slabs);
}
