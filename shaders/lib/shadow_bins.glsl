// Which particles reach a tile of the volumetric shadow map: a tile is where a column of tiles, a row of tiles and a group of planes
// meet, each of these lines has a bit per particle, and the three words are and-ed. Setting bits commutes: the same on every run.
// Include after the push constants.
#include "shaders/shared/constants.h"

layout(constant_id = kIdShadowLanes) const uint kLanes = 8;
const uint kRows = 8;  // texels of its height, all of them a lane's own
const uint kGroup = 6; // planes that a lane has at a time, two layers of the map

uint wordOf(uint particle) { return particle / 256 * 8 + particle % 8; }
uint bitOf(uint particle) { return particle / 8 % 32; }
uint particleAt(uint word, uint bit) { return word / 8 * 256 + bit * 8 + word % 8; }

// First words of the lines: columns, then rows, then groups.
uint columnWords(uint column) { return column * push.words; }
uint rowWords(uint row) { return (push.tiles.x + row) * push.words; }
uint groupWords(uint group) { return (push.tiles.x + push.tiles.y + group) * push.words; }
