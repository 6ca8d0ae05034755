// The particles that the eye sees.
#ifndef BRUME_BLOCK_PARTICLES
#define BRUME_BLOCK_PARTICLES
#include "shaders/shared/types.h"

layout(scalar) readonly buffer Particles { Particle particles[]; };
#endif
