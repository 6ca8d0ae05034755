// The particles' optical depth around local lights, written by local_light_depth.comp: of each volume [y][x][shell].
#ifndef BRUME_BLOCK_LIGHT_DEPTHS
#define BRUME_BLOCK_LIGHT_DEPTHS
layout(scalar) readonly buffer LightDepths { float light_depths[]; };
#endif
