// Points and spots.
#ifndef BRUME_BLOCK_LOCAL_LIGHTS
#define BRUME_BLOCK_LOCAL_LIGHTS
#include "shaders/shared/types.h"

layout(scalar) readonly buffer LocalLights { LocalLight local_lights[]; };
#endif
