// The medium as lamps for surfaces: blocks of cells of the fluxes, each of which shines as one lamp.
#include "shaders/shared/glow.h"

// Places in light space as the fluxes have them: x and y along LightMap::x and y, z the way that the sun's light goes.
struct FluxLamp {
    vec3 place;       // m, from the middle of the cells' bounds
    float square;     // m^2, mean squared distance of its light from there
    vec3 power;       // W of each channel, that go all ways alike
    float through[6]; // part that gets out up each axis, then down each
};

// The part that gets out of the medium in a unit direction: between those along the axes.
float throughToward(FluxLamp lamp, vec3 way) {
    const vec3 square = way * way;
    const vec3 part = vec3(way.x < 0 ? lamp.through[3] : lamp.through[0], way.y < 0 ? lamp.through[4] : lamp.through[1],
                           way.z < 0 ? lamp.through[5] : lamp.through[2]);
    return dot(square, part);
}
