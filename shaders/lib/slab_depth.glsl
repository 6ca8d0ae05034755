// Where slabs lie along a ray: view depth (m) of faces and middles, and the face of a view depth. Face 0 is the near
// one of slab 0, face s + 1 the far one of slab s. Only this file knows that slabs are equally thick. Include after
// `grid` is declared.

float slabThickness(uint slab) { return grid.thickness; }
float faceDepth(uint face) { return grid.depth + float(face) * grid.thickness; }
float middleDepth(uint slab) { return grid.depth + (float(slab) + 0.5) * grid.thickness; }
// View depth where the last slab ends.
float farDepth() { return grid.depth + grid.thickness * float(grid.slabs); }

// Faces and parts of one; not clamped.
float faceAt(float depth) { return (depth - grid.depth) / grid.thickness; }
vec2 facesAt(vec2 depths) { return (depths - grid.depth) / grid.thickness; }
// Sheets of grid.sheet slabs, and parts of one.
float sheetAt(float depth) {
    const float sheet = grid.thickness * float(grid.sheet);
    return (depth - grid.depth) / sheet;
}
