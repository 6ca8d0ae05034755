// Scaling: what a view costs against the number of lights and of objects.
#pragma once

#include <filesystem>
#include <string>

#include "server/gpu/device.h"

namespace brume::bench {

// Tables in Markdown. Scenes are generated into `folder`. `frames`: of each, their median counts.
std::string scalingTables(const gpu::Device& device, uint32_t frames, const std::filesystem::path& folder);

} // namespace brume::bench
