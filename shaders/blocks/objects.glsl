// Opaque objects, planes first; and the tree of boxes and spheres.
#ifndef BRUME_BLOCK_OBJECTS
#define BRUME_BLOCK_OBJECTS
#include "shaders/shared/types.h"

layout(scalar) readonly buffer Objects { Opaque objects[]; };
layout(scalar) readonly buffer ObjectNodes { ObjectNode object_nodes[]; };
#endif
