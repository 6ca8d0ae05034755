// The eye that a pass is for, and its rays in the sun's map. A pass for several eyes reads Views (lib/view.glsl)
// instead.
#ifndef BRUME_BLOCK_EYE
#define BRUME_BLOCK_EYE
#include "shaders/shared/types.h"

layout(scalar) uniform EyeBlock { Eye eye; MapRays map_rays; };
#endif
