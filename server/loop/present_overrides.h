// The present scene as the arguments of a process that compiles its shaders.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "server/inputs/scene_features.h"
#include "server/viewer/audience.h"

namespace brume {

// Overrides that give the scene these values of liveSettings(), and these features that commands change. `way`: all
// settings of [render], so that little else than this way is compiled; null: those of `settings`.
std::vector<std::string> presentOverrides(const SceneFacts& facts, std::span<const SettingValue> settings,
                                          const SceneFeatures& features, const RenderSettings* way = nullptr);

} // namespace brume
