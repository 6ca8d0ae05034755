#include "server/plan/list_prices.h"

#include <algorithm>

#include "server/inputs/local_light_block.h"
#include "server/inputs/objects.h"

namespace brume {

ListPrices listPrices(PlanScene scene, const RenderSettings& settings, const PlanView& view, const CostModel& costs,
                      double most_ms) {
    const auto msOf = [&] {
        Work work = sharedWork(scene, settings);
        work += ViewWork(scene, view).of(settings);
        return work.ms(costs);
    };
    const double now = msOf();
    const auto more = [&] { return std::max(msOf() - now, 0.0); };
    ListPrices prices{.left = std::max(most_ms - now, 0.0)};
    const SceneFeatures had = scene.features;
    scene.features.local_lights = true;
    Light light;
    light.type = "point";
    light.position = 0.5f * (scene.extent.lo + scene.extent.hi);
    for (const bool shadows : {false, true}) {
        light.shadows = shadows;
        scene.local_lights.push_back(localLightBlock(light));
        (shadows ? prices.shadowed_light : prices.light) = more();
        scene.local_lights.pop_back();
    }
    scene.features = had;
    scene.features.opaque = true;
    ++scene.objects; // beyond kMostCounted, too: of planes each pixel asks all
    prices.plane = more();
    scene.objects = std::min(scene.objects, kMostCounted);
    scene.features.casters = scene.features.sun;
    const Box box{.centre = light.position};
    scene.caster_balls.push_back({box.centre, meanRadius(opaqueOf(box))});
    prices.body = more() / scene.caster_weight;
    const auto far = float(limits::kLength.hi);
    scene.caster_balls.back() = {box.centre + far * scene.tick.sun.to_light, 2 * far}; // all is in its shadow
    prices.growth = std::max(more() / scene.caster_weight - prices.body, 0.0);
    return prices;
}

} // namespace brume
