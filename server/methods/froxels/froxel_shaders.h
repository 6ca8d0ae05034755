// What of the settings the shaders of method `froxels` are compiled for.
#pragma once

#include "common/render_settings.h"
#include "shaders/shared/froxels.h"

namespace brume::methods::froxels {

struct FroxelShaders {
    uint32_t shadows = gpu::kShadowsByRay;
    bool history = false; // False also where a picture has none

    auto operator<=>(const FroxelShaders&) const = default; // NOLINT(modernize-use-nullptr): clang-tidy 14: a 0
};

inline FroxelShaders shadersFor(const FroxelSettings& settings) {
    const std::string& name = settings.shadows;
    return {.shadows = name == "none"   ? gpu::kShadowsNone
                       : name == "map"  ? gpu::kShadowsByMap
                       : name == "ray"  ? gpu::kShadowsByRay
                       : name == "grid" ? gpu::kShadowsByGrid
                                        : gpu::kShadowsHybrid,
            .history = settings.history > 0};
}

} // namespace brume::methods::froxels
