// Light that scatters more than once: the part of gpu::Tick that describes it, and numbers of its models.
#pragma once

#include <span>

#include "server/sim/simulation.h"
#include "shaders/shared/multiple.h"
#include "shaders/shared/types.h"

namespace brume {

// Fluxes have the mean albedo of the particles, by extinction and volume; three channels where it or the albedo of
// an object is coloured, or light that is their own. Light scatters once in a union medium, and where there are no
// particles. Precondition: the tick has its sun and the axes of its map.
void setMultiple(gpu::Tick& tick, const Sky& sky, const SceneNow& now, std::span<const gpu::Particle> particles,
                 std::span<const gpu::Opaque> objects);

// The model, gpu::kScatteringSingle and so on, as a tick has it, and as settings ask for it.
inline uint32_t scatteringOf(const gpu::Multiple& multiple) {
    return multiple.cells > 0     ? gpu::kScatteringPropagation
           : multiple.octaves > 0 ? gpu::kScatteringOctaves
                                  : gpu::kScatteringSingle;
}
// True: with scattering = "propagation" the medium gets light of surfaces.
// True: surfaces get the light of the medium's fluxes.
inline bool lightsSurfaces(const gpu::Tick& tick, const PropagationSettings& settings) {
    return tick.multiple.cells > 0 && settings.onto_surfaces && tick.opaque_count + tick.triangle_count > 0;
}
inline bool reflects(const PropagationSettings& settings) { return settings.surface_parts > 0; }
inline uint32_t scatteringOf(const RenderSettings& settings) {
    return settings.scattering == "octaves"       ? gpu::kScatteringOctaves
           : settings.scattering == "propagation" ? gpu::kScatteringPropagation
                                                  : gpu::kScatteringSingle;
}
// A number that differs between settings for which shaders of light that scatters more than once differ, below
// kScatteringShaders.
inline constexpr uint32_t kScatteringShaders = 4;
inline uint32_t scatteringShaders(const RenderSettings& settings) {
    const uint32_t model = scatteringOf(settings);
    return model == gpu::kScatteringPropagation && reflects(settings.propagation) ? kScatteringShaders - 1 : model;
}

} // namespace brume
