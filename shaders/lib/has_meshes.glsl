// Included by whatever asks, in any order.
#ifndef BRUME_HAS_MESHES
#define BRUME_HAS_MESHES
#include "shaders/shared/constants.h"

layout(constant_id = kIdHasMeshes) const bool kHasMeshes = false;
#endif
