// Height along to_light of the topmost box or sphere; -1e30 where there is none.
#ifndef BRUME_BLOCK_OPAQUE_SHADOW
#define BRUME_BLOCK_OPAQUE_SHADOW
uniform sampler2D opaque_shadow;
#endif
