// SceneFeatures: features that shaders are compiled for. Code for absent ones is left out, so they cost nothing.
#pragma once

#include <algorithm>

#include "common/phase_lobes.h"
#include "server/sim/simulation.h"

namespace brume {

struct SceneFeatures {
    bool opaque = false;       // True: there are opaque objects
    bool meshes = false;       // True: some of them are meshes
    bool casters = false;      // True: some of them throw the sun's shadow on the medium; ground planes do not
    bool ambient = false;      // True: the sky sends uniform light into the medium
    bool lobe = false;         // True: hasLobe() the medium
    bool fog = false;          // True: there is fog
    bool glow = false;         // True: some fog emits light
    bool local_lights = false; // True: there are points or spots
    bool operator==(const SceneFeatures&) const = default;
    auto operator<=>(const SceneFeatures&) const = default; // NOLINT(modernize-use-nullptr): clang-tidy 14: a 0
    SceneFeatures operator|(const SceneFeatures& o) const {
        return {opaque || o.opaque, meshes || o.meshes, casters || o.casters, ambient || o.ambient,
                lobe || o.lobe,     fog || o.fog,       glow || o.glow,       local_lights || o.local_lights};
    }
};

inline constexpr float kNoBall = 1e15f; // m, gpu::Fog::radius of a fog that fills no ball, and more

inline bool isThere(const Fog& fog) { return fog.extinction > 0; }

// `now`: what commands change. With local lights pictures always pass through surfaces' targets, as with objects. A sun
// without irradiance has no shadows.
inline SceneFeatures featuresOf(const Scene& scene, const SceneNow& now) {
    const bool bodies = !scene.boxes.empty() || !scene.spheres.empty(), meshes = !scene.triangles.empty();
    const bool local_lights = !now.lists.lights.empty();
    const auto glows = [](const Fog& fog) { return isThere(fog) && fog.emission != glm::vec3(0); };
    return {.opaque = bodies || meshes || !scene.planes.empty() || local_lights,
            .meshes = meshes,
            .casters = (bodies || meshes) && now.light.irradiance != glm::vec3(0),
            .ambient = scene.sky.ambient != glm::vec3(0),
            .lobe = hasLobe(now.medium),
            .fog = std::ranges::any_of(now.lists.fogs, isThere),
            .glow = std::ranges::any_of(now.lists.fogs, glows),
            .local_lights = local_lights};
}

// True: only methods that draw fog, local lights and meshes can draw the scene.
inline bool needsFields(const SceneFeatures& features) {
    return features.fog || features.local_lights || features.meshes;
}

} // namespace brume
