// gpu::LocalLight: points and spots as the shaders want them.
#pragma once

#include <span>

#include "common/scene.h"
#include "server/inputs/scene_features.h"
#include "server/medium/extent.h"
#include "shaders/shared/types.h"

namespace brume {

// Without a volume of the particles' depth.
gpu::LocalLight localLightBlock(const Light& light);
// Gives the light a volume of the particles' depth, for directions to the particles that it shines on. Returns the
// volume's size, in numbers. Directions and distances are as fine as the particles ask for, and coarser where all
// volumes would take too much work or memory. `before`: size of the volumes of other lights, which lie before it.
// `particles`: how many there are; `lights`: how many have a volume. `coarse`: true for fewer directions.
uint32_t setVolume(gpu::LocalLight& light, const MediumExtent& extent, uint32_t particles, uint32_t lights,
                   uint32_t before, bool coarse = false);
// True: lamps are on rays that are as far apart as their light varies, and fewer directions are fine enough.
inline bool hasCoarseVolumes(const RenderSettings& settings) { return settings.lamp_spacing >= 1; }

// True if the rays of a grid hold what an eye sees of the light (shared/lamps.h). `most`: RenderSettings::lamp_spacing.
// Shaders round otherwise: callers move `most` to the side where a light on the edge does no harm.
bool isHeldByRays(const gpu::LocalLight& light, const gpu::Eye& eye, const gpu::SlabGrid& grid, float most);

// Sets LocalLight::smooth_length of all. It is 0 with fog, which a lamp lights beside itself, and of lamps that objects
// may shadow. Else it is the distance to the nearest particle; of a spot that times the angle in which its cone fades.
// `extent`: of the particles. With more than two million pairs of a lamp and a particle its bounds are the nearest.
void setSmoothLengths(std::span<gpu::LocalLight> lights, std::span<const gpu::Particle> particles,
                      const MediumExtent& extent, float falloff, const SceneFeatures& features,
                      std::span<const Plane> planes);

} // namespace brume
