// Floats to integers through the float's own bits: CPU drivers convert lane by lane, which took longer than all else in compose.
#ifndef BRUME_WHOLE
#define BRUME_WHOLE

// The nearest whole number of x in [0, 2^23).
uint nearestWhole(float x) { return floatBitsToUint(x + 8388608.0) & 0x7fffffu; }
uvec3 nearestWhole(vec3 x) { return floatBitsToUint(x + 8388608.0) & 0x7fffffu; }

#endif
