// Values of the shaders' specialization constants that follow from the scene, and from a group of views.
#pragma once

#include "server/gpu/variants.h"
#include "server/inputs/scene_features.h"
#include "server/inputs/view_group.h"

namespace brume {

inline gpu::Constants constantsOf(const SceneFeatures& f) {
    return {{gpu::kIdHasOpaque, f.opaque},     {gpu::kIdHasCasters, f.casters},
            {gpu::kIdHasLobe, f.lobe},         {gpu::kIdHasAmbient, f.ambient},
            {gpu::kIdHasFog, f.fog},           {gpu::kIdHasGlow, f.glow},
            {gpu::kIdHasEmission, f.emission}, {gpu::kIdHasLocalLights, f.local_lights},
            {gpu::kIdHasMeshes, f.meshes},     {gpu::kIdHasGlass, f.glass},
            {gpu::kIdUnion, f.balls},          {gpu::kIdEllipsoids, f.ellipsoids}};
}

// With those of a field of rays.
inline gpu::Constants constantsOf(const SceneFeatures& features, const gpu::FieldColours& colours, uint32_t rate) {
    gpu::Constants all = constantsOf(features);
    all.insert(all.end(), {{gpu::kIdRate, rate},
                           {gpu::kIdSunColours, colours.sun},
                           {gpu::kIdAmbientColours, colours.ambient},
                           {gpu::kIdMultipleColours, colours.multiple},
                           {gpu::kIdScattering, colours.model}});
    return all;
}
inline gpu::Constants constantsOf(const ViewGroup& group) {
    gpu::Constants all = constantsOf(group.any->shared->features, group.colours, group.rate);
    all.push_back({gpu::kIdDepthLayers, group.depth_layers});
    return all;
}

} // namespace brume
