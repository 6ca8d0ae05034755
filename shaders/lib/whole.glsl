// Conversion of floats to integers by the bits of the float. CPU drivers convert lane by lane, which dominated the
// time of compose.
#ifndef BRUME_WHOLE
#define BRUME_WHOLE

// The nearest integer to x, for x in [0, 2^23).
uint nearestWhole(float x) { return floatBitsToUint(x + 8388608.0) & 0x7fffffu; }
uvec3 nearestWhole(vec3 x) { return floatBitsToUint(x + 8388608.0) & 0x7fffffu; }

#endif
