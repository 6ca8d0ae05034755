// What glowing soot emits, of a medium that is a mixture of it and of what is cold.
#ifndef BRUME_SHARED_EMISSION_H
#define BRUME_SHARED_EMISSION_H

#include "real.h"

BRUME_PHYSICS_BEGIN

// Radiance of a part of the medium that hides `hidden` of what is behind it, and scatters `scattered`: the same times
// its albedo. `hidden` is 1 for radiance per optical depth. Soot scatters nothing, and what is cold has an albedo of
// `cold_albedo` > 0 in each channel. So soot is the part 1 - albedo / cold_albedo of the extinction, and 0 where more
// is scattered than what is cold can.
BRUME_FN BRUME_VEC3 emitted(BRUME_VEC3 emission, BRUME_VEC3 cold_albedo, real hidden, BRUME_VEC3 scattered) {
    return max(emission * (hidden - scattered / cold_albedo), BRUME_VEC3(0));
}

BRUME_PHYSICS_END

#endif
