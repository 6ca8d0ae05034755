// The grids of cells that the six fluxes pass (shared/multiple.h), in light space: x and y along LightMap::x and y, z
// the way that the sun's light goes. Include after the tick is declared.
#include "shaders/shared/multiple.h"

layout(push_constant, scalar) uniform Push {
    uint side;     // cells along each side of this grid
    uint first;    // index of its first cell, in all grids
    uint all;      // number of cells of all grids
    uint channels; // 1, or 3: red, green and blue
    uint parity;   // of x + y + z: cells that the first half step computes
    uint half_steps;
    uint last; // 1: the fluence is written
} push;

vec3 cellSize() { return (tick.map.hi - tick.map.lo) / float(push.side); } // m

uint cellAt(uvec3 place, uint side) { return (place.z * side + place.y) * side + place.x; }
// Index of a cell's numbers: its extinction, 1/m, and of each channel extinction times firstScattered().
uint numbersAt(uint cell) { return cell * (1 + push.channels); }
// Index of the six fluxes that leave a cell: up and down.
uint fluxesAt(uint channel, uint cell) { return (channel * push.all + cell) * 6; }

// The cell of a lane, of all that the grid has.
uvec3 placeOf(uint lane) {
    return uvec3(lane % push.side, lane / push.side % push.side, lane / (push.side * push.side));
}
