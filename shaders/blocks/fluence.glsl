// Light of the sun that has scattered more than once (server/effects/propagation/propagation.h).
#ifndef BRUME_BLOCK_FLUENCE
#define BRUME_BLOCK_FLUENCE
uniform sampler2DArray fluence;
#endif
