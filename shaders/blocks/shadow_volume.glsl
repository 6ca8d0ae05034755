// The particles' optical depth toward the sun (lib/light.glsl).
#ifndef BRUME_BLOCK_SHADOW_VOLUME
#define BRUME_BLOCK_SHADOW_VOLUME
uniform sampler2DArray shadow_volume;
#endif
