// Feature of scenes whose particles emit light; code for it is left out of others.
#ifndef BRUME_HAS_EMISSION
#define BRUME_HAS_EMISSION
#include "shaders/shared/constants.h"

layout(constant_id = kIdHasEmission) const bool kHasEmission = false;
#endif
