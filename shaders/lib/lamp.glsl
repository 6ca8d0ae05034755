// Points and spots: which may matter to a pixel, and what they send to a place. Include after `eye`.
#include "shaders/blocks/tick.glsl"
#include "shaders/shared/types.h"

uint lightWords() { return (tick.local_light_count + 31) / 32; }
uint binColumns() { return (eye.size.x + kPixelTile - 1) / kPixelTile; }
// Index of the first word of a pixel's bin.
uint binOf(uvec2 pixel) { return (pixel.y / kPixelTile * binColumns() + pixel.x / kPixelTile) * lightWords(); }

// The part of its intensity that a light sends to a place: by its cone and its range. `away`: from the light, m.
float sentTo(LocalLight light, vec3 away, float distance) {
    const float squares = distance * distance / (light.range * light.range), window = max(1 - squares * squares, 0);
    const float part = (dot(away, light.axis) / max(distance, 1e-20) - light.cos_outer) / light.cone_width;
    const float inside = clamp(part, 0, 1);
    return window * window * inside * inside * (3 - 2 * inside);
}
