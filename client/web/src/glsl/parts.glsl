// PARTS: PART(n) for each of the COUNT textures that a pass writes at once; COUNT is 1, 4 or 8.
#if COUNT == 1
#define PARTS PART(0)
#elif COUNT == 4
#define PARTS PART(0) PART(1) PART(2) PART(3)
#else
#define PARTS PART(0) PART(1) PART(2) PART(3) PART(4) PART(5) PART(6) PART(7)
#endif
layout(location = 0) out vec4 part[COUNT];
