// Tiles of the volumetric shadow map. A tile is a column of tiles and a row of tiles; each such line has a bit for each
// particle (lib/line_bins_write.glsl). Its planes are filled in groups. Include after the push constants.
#include "shaders/shared/constants.h"

const uint kRows = 8;  // texels of a tile's height, all computed by one lane; its width: kIdLanes
const uint kGroup = 6; // planes that a lane computes at a time, two layers of the map
