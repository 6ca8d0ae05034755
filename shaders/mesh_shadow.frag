#version 460
// Height map of meshes under the sun: height along to_light. Blending keeps the largest.
layout(location = 0) in float height_here;
layout(location = 0) out float height;

void main() { height = height_here; }
