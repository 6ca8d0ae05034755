// Scenes with local lights: points and spots. Code for them is left out of others.
#ifndef BRUME_HAS_LOCAL_LIGHTS
#define BRUME_HAS_LOCAL_LIGHTS
#include "shaders/shared/constants.h"

layout(constant_id = kIdHasLocalLights) const bool kHasLocalLights = false;
#endif
