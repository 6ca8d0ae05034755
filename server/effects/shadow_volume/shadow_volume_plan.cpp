#include "server/effects/shadow_volume/shadow_volume_plan.h"

#include <algorithm>

namespace brume {

Work shadowWork(const PlanScene& scene, const PlanScene::Shadow& shadow) {
    Work work;
    const ShadowResolution& map = shadow.resolution;
    const glm::vec3 size = scene.tick.map.hi - scene.tick.map.lo;
    const glm::vec3 cell = size / glm::vec3(glm::vec2(map.texels), float(std::max(map.slices, 2u) - 1));
    if (scene.features.tetrahedra) {
        work[costs::kTetrahedraShadow] = double(map.texels.x) * map.texels.y * tetrahedraOnRay(scene.particles);
        return work;
    }
    double touched = 0;
    for (const gpu::Particle& p : scene.sample) {
        const double reach = 2 * scene.support(p);
        if (reach <= 0) continue;
        // In tiles of 8x8 texels and groups of planes: half a tile on either side besides.
        touched += std::min(reach / double(cell.x) + 8, double(map.texels.x)) *
                   std::min(reach / double(cell.y) + 8, double(map.texels.y)) *
                   std::min(reach / double(cell.z) + 6, double(map.slices));
    }
    work[costs::kShadowVolume] = touched * scene.weight() + 4.0 * map.texels.x * map.texels.y * map.slices;
    return work;
}

namespace effects::shadow_volume {

// Its work is added where the plan has chosen a resolution.
const EffectPlan& plan() {
    static const EffectPlan kPlan({&costs::kShadowVolume, &costs::kTetrahedraShadow});
    return kPlan;
}

} // namespace effects::shadow_volume
} // namespace brume
