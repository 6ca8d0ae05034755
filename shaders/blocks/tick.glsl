// The tick: the scene beside its particles, and the sun.
#ifndef BRUME_BLOCK_TICK
#define BRUME_BLOCK_TICK
#include "shaders/shared/types.h"

layout(scalar) uniform TickBlock { Tick tick; };
#endif
