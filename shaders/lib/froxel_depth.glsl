// View depths of the faces of froxels, m, and the face of a view depth. Face f is the near one of slice f. Include
// after `push.froxels` is declared.

float faceDepth(float face) {
    return push.froxels.near + push.froxels.unit * (exp2(push.froxels.growth * face) - 1);
}
float faceAt(float depth) {
    return log2(1 + max(depth - push.froxels.near, 0) / push.froxels.unit) / push.froxels.growth;
}

// Index of a ray's value at a face, in the volume [face][row][column].
uint froxelAt(uint face, uvec2 ray) { return (face * push.froxels.rays.y + ray.y) * push.froxels.rays.x + ray.x; }
