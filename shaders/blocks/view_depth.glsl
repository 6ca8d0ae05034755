// View depth of the eye's nearest surface, m.
#ifndef BRUME_BLOCK_VIEW_DEPTH
#define BRUME_BLOCK_VIEW_DEPTH
uniform sampler2D view_depth;
#endif
