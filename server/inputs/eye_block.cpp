#include "server/inputs/eye_block.h"

namespace brume {
namespace {

uint32_t cover(uint32_t pixels, uint32_t step) { return (pixels + step - 1) / step; }

} // namespace

gpu::Eye eyeBlock(const EyeRequest& request, const RenderSettings& settings) {
    const glm::mat3 axes = glm::mat3_cast(glm::normalize(request.pose.orientation));
    gpu::Eye eye{};
    eye.position = request.pose.position;
    eye.near_depth = kNearDepth;
    eye.right = axes[0];
    eye.up = axes[1];
    eye.back = axes[2];
    const Frustum frustum = frustumOf(request.pose, request.width, request.height);
    eye.tan_x = 0.5f * (frustum.left + frustum.right);
    eye.tan_y = 0.5f * (frustum.up + frustum.down);
    eye.exposure = settings.exposure;
    eye.size = {request.width, request.height};
    eye.filmic = settings.tone_map == "filmic";
    eye.ray_right = eye.right * (2 * eye.tan_x / float(request.width));
    eye.ray_down = eye.up * (-2 * eye.tan_y / float(request.height));
    eye.ray = -eye.back - frustum.left * eye.right + frustum.up * eye.up;
    eye.show = request.show;
    return eye;
}

gpu::MapRays mapRays(const gpu::Eye& eye, const gpu::LightMap& map) {
    const auto inMap = [&](glm::vec3 x, float w) {
        const glm::vec4 h(x, w);
        return glm::vec3(glm::dot(map.u, h), glm::dot(map.v, h), glm::dot(map.plane, h));
    };
    return {inMap(eye.position, 1), inMap(eye.ray, 0), inMap(eye.ray_right, 0), inMap(eye.ray_down, 0)};
}

EyeRequest everyStep(const EyeRequest& eye, uint32_t step) {
    if (step == 1) return eye;
    const Frustum f = frustumOf(eye.pose, eye.width, eye.height);
    const float pixel = (f.left + f.right) / float(eye.width), before = (1.5f * float(step) - 0.5f) * pixel;
    EyeRequest coarse{eye.pose, cover(eye.width, step) + 3, cover(eye.height, step) + 3, eye.second};
    const float wide = float(coarse.width * step) * pixel, high = float(coarse.height * step) * pixel;
    coarse.pose.frustum = {f.left + before, wide - f.left - before, f.up + before, high - f.up - before};
    return coarse;
}

bool nearPlaneCuts(const gpu::Tick& tick, const EyeRequest& eye) {
    const glm::vec3 x = eye.pose.position;
    const glm::vec3 at(glm::dot(tick.map.x, x), glm::dot(tick.map.y, x), glm::dot(tick.sun.to_light, x));
    const glm::vec3 outside = glm::max(glm::max(tick.map.lo - at, at - tick.map.hi), glm::vec3(0));
    return glm::length(outside) < 2 * kNearDepth * cornerLength(frustumOf(eye.pose, eye.width, eye.height));
}

} // namespace brume
