// Bits of the particles that reach a tile of the volumetric shadow map. A tile is the intersection of a column of
// tiles, a row of tiles and a group of planes. Each such line has a bit per particle; and-ing three words gives the
// particles of a tile. The order in which bits are set does not matter, so that every run gives the same result.
// Include after the push constants.
#include "shaders/shared/constants.h"

layout(constant_id = kIdShadowLanes) const uint kLanes = 8;
const uint kRows = 8;  // texels of a tile's height, all computed by one lane
const uint kGroup = 6; // planes that a lane computes at a time, two layers of the map

uint wordOf(uint particle) { return particle / 256 * 8 + particle % 8; }
uint bitOf(uint particle) { return particle / 8 % 32; }
uint particleAt(uint word, uint bit) { return word / 8 * 256 + bit * 8 + word % 8; }

// Index of the first word of a line: columns, then rows, then groups.
uint columnWords(uint column) { return column * push.words; }
uint rowWords(uint row) { return (push.tiles.x + row) * push.words; }
uint groupWords(uint group) { return (push.tiles.x + push.tiles.y + group) * push.words; }
