// Height along to_light of the topmost mesh; -1e30 where there is none (server/opaque/mesh_shadow.h).
#ifndef BRUME_BLOCK_MESH_HEIGHTS
#define BRUME_BLOCK_MESH_HEIGHTS
uniform sampler2D mesh_heights;
#endif
