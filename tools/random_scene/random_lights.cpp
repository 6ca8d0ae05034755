#include "tools/random_scene/random_lights.h"

#include <algorithm>

#include "common/scene_limits.h"
#include "tools/random_scene/random_layout.h"

namespace brume {
namespace {

constexpr uint64_t kMostFogs = 2, kMostLights = 6;

glm::vec3 colour(Random& random) {
    const float r = random.uniform(0.2f, 1), g = random.uniform(0.2f, 1);
    return {r, g, random.uniform(0.2f, 1)};
}

// In the medium, or up to 1.5 radii from its middle.
glm::vec3 placeOf(const LitPlace& place, Random& random) {
    const glm::vec3 beside = 1.5f * place.radius * random.inBall();
    const glm::vec3 point = place.points[random.bits() % place.points.size()];
    return random.bits() % 2 == 0 ? beside : point + 0.2f * place.radius * random.inBall();
}

Fog randomFog(float reach, const LitPlace& place, Random& random) {
    enum Kind : uint64_t { everywhere, height, layer, ball, kinds };
    Fog fog;
    const uint64_t kind = random.bits() % kinds;
    const float radius = place.radius;
    const float low = radius * random.uniform(-1, 0.5f), thick = radius * random.uniform(0.3f, 2);
    fog.extinction = limits::kExtinction.clamp(logUniform(random, 0.02f, 2) / reach);
    if (kind == height) { // no denser than e times that, wherever the eye is
        fog.height = low, fog.lo = low - thick;
        fog.falloff = 1 / thick;
    }
    if (kind == layer) fog.lo = low, fog.hi = low + thick;
    const glm::vec3 centre = 0.8f * radius * random.inBall();
    if (kind == ball) fog.centre = centre, fog.radius = 0.7f * thick;
    fog.albedo = colour(random);
    const bool has_lobe = random.bits() % 2 == 0, glows = random.bits() % 4 == 0;
    const float part = random.uniform(), asymmetry = random.uniform(-0.9f, 0.9f);
    if (has_lobe) fog.anisotropy = part, fog.asymmetry = asymmetry;
    const glm::vec3 glow = colour(random);
    if (glows) fog.emission = glow;
    return fog;
}

} // namespace

void addRandomFogs(Scene& scene, const LitPlace& place, Random random) {
    const float reach = std::max(place.radius, glm::distance(scene.camera.position, scene.camera.target));
    const uint64_t count = random.bits() % (kMostFogs + 1);
    for (uint64_t i = 0; i < count; ++i) scene.fogs.push_back(randomFog(reach, place, random));
}

void addRandomLights(Scene& scene, const LitPlace& place, Random random) {
    const uint64_t count = random.bits() % (kMostLights + 1);
    for (uint64_t i = 0; i < count; ++i) {
        Light light;
        const bool is_spot = random.bits() % 3 == 0, ends = random.bits() % 2 == 0;
        light.type = is_spot ? kSpot : kPoint;
        light.position = placeOf(place, random);
        const float half = 0.5f * place.radius, factor = logUniform(random, 0.1f, 10);
        light.intensity = 10 * half * half * factor * colour(random);
        light.radius = place.radius * logUniform(random, 0.001f, 0.05f);
        const float range = place.radius * random.uniform(0.5f, 3);
        if (ends) light.range = range;
        light.shadows = random.bits() % 4 != 0;
        const glm::vec3 to = place.points[random.bits() % place.points.size()] - light.position;
        const glm::vec3 away = random.direction();
        const float outer = random.uniform(0.15f, 1.2f), inner = outer * random.uniform(0.3f, 0.95f);
        if (is_spot) {
            light.axis = glm::dot(to, to) > 1e-6f ? glm::normalize(to) : away;
            light.outer = outer, light.inner = inner;
        }
        scene.lights.push_back(light);
    }
}

} // namespace brume
