// SceneFeatures: features that shaders are compiled for. Code for absent ones is left out, so they cost nothing.
#pragma once

#include "common/scene.h"

namespace brume {

struct SceneFeatures {
    bool opaque = false;  // True: there are opaque objects
    bool casters = false; // True: some of them throw shadows on the medium; ground planes do not
    bool lobe = false;    // True: anisotropy > 0, the phase function has a lobe
    bool ambient = false; // True: the sky sends uniform light into the medium
    bool operator==(const SceneFeatures&) const = default;
    SceneFeatures operator|(const SceneFeatures& o) const {
        return {opaque || o.opaque, casters || o.casters, lobe || o.lobe, ambient || o.ambient};
    }
};

// `medium`: as it is now, since commands change its anisotropy.
inline SceneFeatures featuresOf(const Scene& scene, const Medium& medium) {
    const bool casters = !scene.boxes.empty() || !scene.spheres.empty();
    return {casters || !scene.planes.empty(), casters, medium.anisotropy > 0, scene.sky.ambient != glm::vec3(0)};
}

} // namespace brume
