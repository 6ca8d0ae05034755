#include "tools/bench/phase_error.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "shaders/shared/phase.h"
#include "tools/bench/error.h"
#include "tools/reference/camera.h"

namespace brume::bench {

nlohmann::json phaseRows(const gpu::Device& device, const std::vector<NamedCase>& cases, glm::uvec2 size) {
    nlohmann::json rows = nlohmann::json::array();
    for (const NamedCase& one : cases) {
        Stage stage(device, one.wanted);
        const RadianceImage exact = stage.picture(stage.pose(), size);
        const double g = double(stage.scene().medium.asymmetry);
        const glm::dvec3 travel_in = -glm::normalize(glm::dvec3(sunOf(stage.scene()).to_light));
        const reference::Camera camera = reference::perspective(stage.pose(), int(size.x), int(size.y));
        RadianceImage picture = exact;
        double least = 1e30, most = 0;
        for (uint32_t y = 0; y < size.y; ++y)
            for (uint32_t x = 0; x < size.x; ++x) {
                const glm::dvec3 travel_out = -reference::rayThrough(camera, x + 0.5, y + 0.5).direction;
                const double ratio = physics::phaseSchlick(travel_in, travel_out, g) /
                                     physics::phaseHenyeyGreenstein(travel_in, travel_out, g);
                least = std::min(least, ratio), most = std::max(most, ratio);
                picture.radiance[size_t(y) * size.x + x] *= float(ratio);
            }
        const MediumError error = mediumError(picture, exact, displayOf(stage.scene().render));
        rows.push_back({{"scene", one.wanted.scene},
                        {"camera", one.wanted.camera},
                        {"variant", one.name},
                        {"set", one.wanted.set},
                        {"size", std::to_string(size.x) + 'x' + std::to_string(size.y)},
                        {"least_ratio", least},
                        {"most_ratio", most},
                        {"beside", toJson(error)}});
        std::fprintf(stderr, "  %-12s %-8s %-24s %s\n", one.wanted.scene.c_str(), one.wanted.camera.c_str(),
                     one.name.c_str(), inShort(error).c_str());
    }
    return rows;
}

} // namespace brume::bench
