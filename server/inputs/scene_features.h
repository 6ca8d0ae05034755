// SceneFeatures: features that shaders are compiled for. Code for absent ones is left out, so they cost nothing.
#pragma once

#include <algorithm>

#include "common/phase_lobes.h"
#include "server/sim/simulation.h"

namespace brume {

struct SceneFeatures {
    bool opaque = false;  // True: there are opaque objects, or pictures pass through surfaces' targets all the same
    bool meshes = false;  // True: some of them are meshes
    bool bodies = false;  // True: some of them are boxes or spheres
    bool casters = false; // True: meshes or these throw the sun's shadow on the medium
    bool ambient = false; // True: the sky sends uniform light into the medium
    bool lobe = false;    // True: hasLobe() the medium
    bool fog = false;     // True: there is fog
    bool glow = false;    // True: some fog emits light
    bool local_lights = false; // True: there are points or spots
    bool balls = false;        // True: the medium is the union of balls
    bool glass = false;        // True: there are sheets of glass
    bool tetrahedra = false;   // True: the medium is of tetrahedra
    bool ellipsoids = false;   // True: particles have three axes
    bool volume = false;       // True: the medium is a volume
    bool sun = false;          // True: the directional light has an irradiance
    bool emission = false;     // True: particles emit light
    bool operator==(const SceneFeatures&) const = default;
    auto operator<=>(const SceneFeatures&) const = default; // NOLINT(modernize-use-nullptr): clang-tidy 14: a 0
    SceneFeatures operator|(const SceneFeatures& o) const {
        return {opaque || o.opaque,
                meshes || o.meshes,
                bodies || o.bodies,
                casters || o.casters,
                ambient || o.ambient,
                lobe || o.lobe,
                fog || o.fog,
                glow || o.glow,
                local_lights || o.local_lights,
                balls || o.balls,
                glass || o.glass,
                tetrahedra || o.tetrahedra,
                ellipsoids || o.ellipsoids,
                volume || o.volume,
                sun || o.sun,
                emission || o.emission};
    }
};

inline constexpr float kNoBall = 1e15f; // m, gpu::Fog::radius of a fog that fills no ball, and more

inline bool isThere(const Fog& fog) { return fog.extinction > 0; }

// Those that commands change. With local lights pictures always pass through surfaces' targets, as with objects.
inline SceneFeatures featuresOf(const SceneNow& now) {
    const SceneLists& lists = now.lists;
    const auto glows = [](const Fog& fog) { return isThere(fog) && fog.emission != glm::vec3(0); };
    const bool bodies = !lists.boxes.empty() || !lists.spheres.empty() || lists.laid_out > 0,
               local_lights = !lists.lights.empty();
    return {.opaque = bodies || !lists.planes.empty() || local_lights,
            .bodies = bodies,
            .lobe = hasLobe(now.medium),
            .fog = std::ranges::any_of(lists.fogs, isThere),
            .glow = std::ranges::any_of(lists.fogs, glows),
            .local_lights = local_lights,
            .sun = now.light.irradiance != glm::vec3(0),
            .emission = now.medium.emission != glm::vec3(0)};
}
// All of them. `drawn`: those that commands change and that are drawn with, whatever there is. A sun without irradiance
// has no shadows.
inline SceneFeatures featuresOf(const Scene& scene, const SceneNow& now, const SceneFeatures& drawn = {}) {
    SceneFeatures all = featuresOf(now) | drawn;
    all.meshes |= !scene.triangles.empty();
    all.glass |= !scene.glasses.empty();
    all.opaque |= all.meshes || all.glass;
    all.casters |= (all.bodies || all.meshes) && all.sun;
    all.ambient |= scene.sky.ambient != glm::vec3(0);
    all.balls |= now.medium.model == kUnionMedium;
    all.tetrahedra |= now.medium.model == kTetrahedraMedium;
    all.ellipsoids |= now.medium.model == kEllipsoidMedium;
    all.volume |= now.medium.model == kVolumeMedium;
    return all;
}
// Takes out what shaders that are compiled for `features` do not draw.
inline void leaveOut(SceneNow& now, const SceneFeatures& features) {
    SceneLists& lists = now.lists;
    if (!features.local_lights) lists.lights.clear();
    if (!features.fog) lists.fogs.clear();
    if (!features.glow)
        for (Fog& fog : lists.fogs) fog.emission = glm::vec3(0);
    if (!features.opaque) lists.planes.clear();
    if (!features.bodies) lists.boxes.clear(), lists.spheres.clear();
    if (!features.lobe) now.medium.phase = kMixturePhase, now.medium.anisotropy = 0;
    if (!features.sun) now.light.irradiance = glm::vec3(0);
    if (!features.emission) now.medium.emission = glm::vec3(0);
}

// True: there is light or medium to draw where no particle is.
inline bool hasExtras(const SceneFeatures& features) {
    return features.fog || features.local_lights || features.meshes;
}

} // namespace brume
