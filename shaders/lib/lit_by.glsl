// What points and spots send to a place, without pixels: what lib/local_lights.glsl has, and the particles' depth.
#include "shaders/lib/local_lights.glsl"
#include "shaders/lib/local_light_depth.glsl"
