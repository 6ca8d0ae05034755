#include "tools/bench/ground_error.h"

#include <cmath>

#include "common/scene_reader.h"
#include "server/inputs/eye_request.h"
#include "tools/bench/error.h"
#include "tools/reference/camera.h"
#include "tools/reference/geometry.h"
#include "tools/reference/obstacle_tree.h"

namespace brume::bench {
namespace {

constexpr float kSeen = 1e-20f; // transmittance below which a surface is not seen

} // namespace

GroundError groundError(const gpu::Device& device, const Case& wanted, glm::uvec2 size, uint32_t ticks) {
    Case black = wanted;
    black.set.insert(black.set.end(), std::begin(kMediumAlone), std::end(kMediumAlone));
    black.set.emplace_back("medium.albedo=[0,0,0]");
    Stage stage(device, black, ticks);
    const SceneNow& now = stage.simulation().now();
    if (now.medium.model != kUnionMedium)
        throw SceneError(wanted.scene + ": ground = true is of medium.model = \"union\"");
    const reference::World world =
        reference::worldOf(stage.scene(), stage.particles(), {now.medium, now.light, now.lists.lights, now.lists.fogs});
    const reference::Camera camera = reference::perspective(stage.pose(), int(size.x), int(size.y), kNearDepth);
    const glm::dvec3 to_light = glm::normalize(glm::dvec3(now.light.to_light));
    const RadianceImage picture = stage.picture(stage.pose(), size);
    const auto objectAt = [&](double x, double y) {
        return reference::nearest(world.obstacles, reference::rayThrough(camera, x, y)).object;
    };
    GroundError error;
    double squares = 0, sum = 0;
    std::vector<reference::Interval> parts;
    for (uint32_t y = 0; y < size.y; ++y)
        for (uint32_t x = 0; x < size.x; ++x) {
            const reference::Ray ray = reference::rayThrough(camera, x + 0.5, y + 0.5);
            const reference::Hit hit = reference::nearest(world.obstacles, ray);
            const size_t at = size_t(y) * size.x + x;
            if (hit.object < 0 || !(picture.transmittance[at] > kSeen)) continue;
            const double cosine = glm::dot(hit.normal, to_light);
            bool edge = false; // of an object: the renderer smooths it
            for (const glm::uvec2 corner : {glm::uvec2(0, 0), {1, 0}, {0, 1}, {1, 1}})
                edge = edge || objectAt(x + corner.x, y + corner.y) != hit.object;
            const reference::Ray toward{ray.at(hit.t), to_light};
            if (edge || !(cosine > 0.01) || reference::occluded(world.obstacles, toward, hit.object)) continue;
            reference::insideUnion(world.balls, toward, parts);
            if (parts.empty()) continue;
            double path = 0;
            for (const reference::Interval part : parts) path += part.end - part.begin;
            const reference::Obstacle& object = world.obstacles[size_t(hit.object)];
            const double full =
                reference::albedoAt(object, ray, hit.t).r * cosine / reference::kPi * double(now.light.irradiance.r);
            const double got = double(picture.radiance[at].r) / (double(picture.transmittance[at]) * full);
            const double difference = got - std::exp(-world.balls.sigma_t * path);
            squares += difference * difference, sum += difference, error.places += 1;
        }
    error.rms = std::sqrt(squares / error.places), error.bias = sum / error.places;
    return error;
}

} // namespace brume::bench
