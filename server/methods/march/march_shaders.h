// What of the settings the shaders of method `march` are compiled for.
#pragma once

#include <optional>

#include "common/render_settings.h"
#include "shaders/shared/march.h"

namespace brume::methods::march {

inline uint32_t jitterOf(const MarchSettings& settings) {
    return settings.jitter == "offset"       ? gpu::kJitterOffset
           : settings.jitter == "stratified" ? gpu::kJitterStratified
                                             : gpu::kJitterOpacity;
}

// Nothing: pictures are not blurred.
inline std::optional<uint32_t> blurOf(const MarchSettings& settings) {
    if (settings.blur == "none") return {};
    return settings.blur == "row14" ? gpu::kBlurRow14 : settings.blur == "printed" ? gpu::kBlurPrinted : gpu::kBlurBox8;
}

} // namespace brume::methods::march
