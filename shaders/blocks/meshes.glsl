// The triangles of meshes; and their tree in several orders, one after the other.
#ifndef BRUME_BLOCK_MESHES
#define BRUME_BLOCK_MESHES
#include "shaders/shared/types.h"

layout(scalar) readonly buffer Triangles { Triangle triangles[]; };
layout(scalar) readonly buffer MeshNodes { ObjectNode mesh_nodes[]; };
#endif
