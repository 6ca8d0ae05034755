// The semi-axes of particles that are no balls.
#ifndef BRUME_BLOCK_AXES
#define BRUME_BLOCK_AXES
#include "shaders/shared/constants.h"
#include "shaders/shared/ellipsoid.h"
#include "shaders/shared/types.h"

layout(constant_id = kIdEllipsoids) const bool kEllipsoids = false;

layout(scalar) readonly buffer Axes { EllipsoidAxes axes[]; }; // of each particle; read only if they are ellipsoids
#endif
