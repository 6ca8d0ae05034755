// Light on a picture of smoke from six sides: the ambient cube of McTaggart (Half-Life 2 Source Shading, 2004) for one
// light.
#ifndef BRUME_SHARED_SIX_WAY_H
#define BRUME_SHARED_SIX_WAY_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// Weight of the maps of an axis. The three weights of a unit direction add up to 1.
BRUME_FN real sixWayWeight(real along) { return along * along; }

// `toward`: unit, to the light, along the picture's right, up and front. `positive`: light from the right, the top and
// the front; `negative`: from the left, the bottom and the back.
BRUME_FN real sixWayLight(BRUME_VEC3 toward, BRUME_VEC3 positive, BRUME_VEC3 negative) {
    return sixWayWeight(toward.x) * (toward.x > real(0) ? positive.x : negative.x) +
           sixWayWeight(toward.y) * (toward.y > real(0) ? positive.y : negative.y) +
           sixWayWeight(toward.z) * (toward.z > real(0) ? positive.z : negative.z);
}

BRUME_PHYSICS_END

#endif
