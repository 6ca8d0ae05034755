// SceneFeatures: features that shaders are compiled for. Code for absent ones is left out, so they cost nothing.
#pragma once

#include "common/phase_lobes.h"

namespace brume {

struct SceneFeatures {
    bool opaque = false;  // True: there are opaque objects
    bool casters = false; // True: some of them throw shadows on the medium; ground planes do not
    bool lobe = false;    // True: hasLobe() the medium
    bool ambient = false; // True: the sky sends uniform light into the medium
    bool operator==(const SceneFeatures&) const = default;
    SceneFeatures operator|(const SceneFeatures& o) const {
        return {opaque || o.opaque, casters || o.casters, lobe || o.lobe, ambient || o.ambient};
    }
};

// `medium`: as it is now, since commands change its phase function.
inline SceneFeatures featuresOf(const Scene& scene, const Medium& medium) {
    const bool casters = !scene.boxes.empty() || !scene.spheres.empty();
    return {casters || !scene.planes.empty(), casters, hasLobe(medium), scene.sky.ambient != glm::vec3(0)};
}

} // namespace brume
