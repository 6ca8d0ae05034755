// Which shaders method `gradients` has, by its settings.
#pragma once

#include "common/render_settings.h"

namespace brume {

enum class LightShaders : uint8_t { exact, nested, spheres };

inline LightShaders lightShaders(const RadianceSettings& settings) {
    return settings.interpolation == "exact"    ? LightShaders::exact
           : settings.interpolation == "nested" ? LightShaders::nested
                                                : LightShaders::spheres;
}

} // namespace brume
