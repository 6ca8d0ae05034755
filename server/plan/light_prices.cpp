#include "server/plan/light_prices.h"

#include <algorithm>

#include "server/inputs/local_light_block.h"

namespace brume {

LightPrices lightPrices(PlanScene scene, const RenderSettings& settings, const PlanView& view, const CostModel& costs,
                        double most_ms) {
    const auto msOf = [&] {
        Work work = sharedWork(scene, settings);
        work += ViewWork(scene, view).of(settings);
        return work.ms(costs);
    };
    Light light;
    light.type = "point";
    light.position = 0.5f * (scene.extent.lo + scene.extent.hi);
    const double now = msOf();
    const auto withOneMore = [&](bool shadows) {
        light.shadows = shadows;
        scene.local_lights.push_back(localLightBlock(light));
        const double more = msOf() - now;
        scene.local_lights.pop_back();
        return std::max(more, 0.0);
    };
    scene.features.local_lights = true;
    return {std::max(most_ms - now, 0.0), withOneMore(false), withOneMore(true)};
}

} // namespace brume
