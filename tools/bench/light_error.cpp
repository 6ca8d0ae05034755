#include "tools/bench/light_error.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "server/inputs/tick_block.h"
#include "server/medium/shadow_resolution.h"
#include "tools/bench/error.h"

namespace brume::bench {
namespace {

using nlohmann::json;

double shadowMs(const FrameCost& frame) {
    for (const FrameCost::Pass& pass : frame.passes)
        if (pass.name == "shadow volume") return pass.ms;
    return 0;
}

struct Map {
    glm::uvec2 texels;
    uint32_t slices;
    double error; // estimated
};

Map mapOf(const Stage& stage) {
    const std::vector<gpu::Particle> particles = stage.particles();
    const SceneNow& now = stage.simulation().now();
    const gpu::Tick tick = makeTick(stage.scene(), now, particles, {});
    const ShadowedMedium medium(particles, tick.falloff, glm::mat3(tick.map.x, tick.map.y, tick.sun.to_light));
    return {tick.map.texels, tick.map.slices, shadowResolution(now.render, medium, tick.map.hi - tick.map.lo).error};
}

} // namespace

json lightRows(const gpu::Device& device, const std::vector<NamedCase>& cases, glm::uvec2 size, const Effort& effort) {
    std::vector<std::unique_ptr<Stage>> stages;
    std::vector<std::vector<double>> times(cases.size());
    for (const NamedCase& one : cases) {
        stages.push_back(std::make_unique<Stage>(device, one.wanted));
        stages.back()->frame(); // compiles shaders, fits buffers
    }
    double spent = 0;
    for (uint32_t round = 0; round < effort.least || spent < effort.seconds * 1e3 * double(cases.size()); ++round)
        for (size_t i = 0; i < stages.size(); ++i) {
            const FrameCost frame = stages[i]->frame();
            times[i].push_back(shadowMs(frame));
            spent += frame.wall_ms;
        }

    Case finest = cases.front().wanted;
    finest.set.insert(finest.set.end(), {"render.shadow_size=512", "render.shadow_slices=128"});
    Stage reference(device, finest);
    const RadianceImage exact = reference.picture(reference.pose(), size);
    json rows = json::array();
    for (size_t i = 0; i < stages.size(); ++i) {
        const Errors errors =
            mediumError(stages[i]->picture(stages[i]->pose(), size), exact, displayOf(stages[i]->scene().render))
                .medium;
        const Map map = mapOf(*stages[i]);
        const double ms = median(times[i]);
        rows.push_back({{"scene", cases[i].wanted.scene},
                        {"camera", cases[i].wanted.camera},
                        {"variant", cases[i].name},
                        {"set", cases[i].wanted.set},
                        {"columns", map.texels.x},
                        {"rows", map.texels.y},
                        {"planes", map.slices},
                        {"shadow_ms", ms},
                        {"frames", times[i].size()},
                        {"estimated", map.error},
                        {"relative_rmse", errors.relative_rmse},
                        {"bias", errors.bias},
                        {"flip", errors.flip}});
        std::fprintf(stderr, "  %-12s %-8s %-24s %4ux%ux%-4u %8.2f ms  %.3f %%, estimated %.3f %%\n",
                     cases[i].wanted.scene.c_str(), cases[i].wanted.camera.c_str(), cases[i].name.c_str(), map.texels.x,
                     map.texels.y, map.slices, ms, 100 * errors.relative_rmse, 100 * map.error);
    }
    return rows;
}

} // namespace brume::bench
