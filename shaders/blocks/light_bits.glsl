// Bits of the local lights that may reach each bin of the eye's pixels, written by local_light_bins.comp.
#ifndef BRUME_BLOCK_LIGHT_BITS
#define BRUME_BLOCK_LIGHT_BITS
layout(scalar) readonly buffer LightBits { uint light_bits[]; };
#endif
