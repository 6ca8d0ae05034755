// setBalls(): the part of gpu::Tick that describes the medium as the union of balls.
#pragma once

#include <span>

#include "common/scene.h"
#include "shaders/shared/types.h"

namespace brume {

// True: the medium is a union of balls, or the settings take the sun's light as if it were.
inline bool needsBalls(const Medium& medium, const RenderSettings& render) {
    return medium.model == kUnionMedium || render.tiles.light == "path";
}

// Fits the cells to the particles: about one for each three of them. Precondition: the tick has the sun's axes.
void setBalls(gpu::Tick& tick, const Medium& medium, const RenderSettings& render,
              std::span<const gpu::Particle> particles);

} // namespace brume
