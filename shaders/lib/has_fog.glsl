// Features of scenes with fog; code for absent ones is left out.
#ifndef BRUME_HAS_FOG
#define BRUME_HAS_FOG
#include "shaders/shared/constants.h"

layout(constant_id = kIdHasFog) const bool kHasFog = false;
layout(constant_id = kIdHasGlow) const bool kHasGlow = false; // True: some fog emits light
#endif
