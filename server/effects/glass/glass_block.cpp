#include "server/effects/glass/glass_block.h"

#include <algorithm>
#include <cmath>

#include "common/scene_limits.h"
#include "server/inputs/eye_request.h"

namespace brume {
namespace {

static_assert(limits::kGlasses.hi == gpu::kMostGlasses);

// False: all corners are beyond the near plane or the same side of the picture.
bool mayBeSeen(const gpu::GlassSheet& sheet, const Pose& pose, const Frustum& frustum) {
    const glm::mat3 axes = glm::mat3_cast(pose.orientation);
    const glm::vec3 across = sheet.across / glm::dot(sheet.across, sheet.across),
                    along = sheet.along / glm::dot(sheet.along, sheet.along);
    int before = 0, left = 0, right = 0, above = 0, below = 0;
    for (int corner = 0; corner < 4; ++corner) {
        const glm::vec3 at =
            sheet.centre + (corner & 1 ? 1.0f : -1.0f) * across + (corner & 2 ? 1.0f : -1.0f) * along - pose.position;
        const float x = glm::dot(at, axes[0]), y = glm::dot(at, axes[1]), z = -glm::dot(at, axes[2]);
        before += z < kNearDepth;
        left += x<-frustum.left * z, right += x> frustum.right * z;
        above += y > frustum.up * z, below += y < -frustum.down * z;
    }
    return std::max({before, left, right, above, below}) < 4;
}

} // namespace

gpu::GlassSheet glassSheet(const Glass& glass) {
    const float yaw_sin = std::sin(glass.yaw), yaw_cos = std::cos(glass.yaw), pitch_sin = std::sin(glass.pitch),
                pitch_cos = std::cos(glass.pitch);
    return {.centre = glass.centre,
            .reflectance = glass.reflectance,
            .across = glm::vec3(yaw_cos, 0, -yaw_sin) * (2 / glass.width),
            .along = glm::vec3(yaw_sin * pitch_sin, pitch_cos, yaw_cos * pitch_sin) * (2 / glass.height),
            .normal = {yaw_sin * pitch_cos, -pitch_sin, yaw_cos * pitch_cos},
            .transmittance = glass.transmittance};
}

uint32_t glassLayers(std::span<const Glass> glasses, const Pose& pose, const Frustum& frustum) {
    const auto seen =
        std::ranges::count_if(glasses, [&](const Glass& glass) { return mayBeSeen(glassSheet(glass), pose, frustum); });
    return std::min(uint32_t(seen), gpu::kGlassLayers);
}

} // namespace brume
