#include "tools/reference/camera.h"

#include <cmath>

namespace brume::reference {

Camera perspective(const Pose& pose, int width, int height, double near_depth) {
    Camera camera{.width = width, .height = height, .position = pose.position, .near_depth = near_depth};
    camera.world_from_view = glm::mat3_cast(glm::normalize(glm::dquat(pose.orientation)));
    camera.half_height = std::tan(pose.fov_y / 2.0);
    return camera;
}

Camera orthographic(const Pose& pose, int width, int height, double height_m) {
    Camera camera = perspective(pose, width, height);
    camera.orthographic = true;
    camera.half_height = height_m / 2;
    return camera;
}

Ray rayThrough(const Camera& camera, double x, double y) {
    const double right = (2 * x - camera.width) / camera.height * camera.half_height;
    const double up = (1 - 2 * y / camera.height) * camera.half_height;
    const double pixel = 2 * camera.half_height / camera.height;
    const glm::dvec3 step_right = pixel * camera.world_from_view[0], step_down = -pixel * camera.world_from_view[1];
    if (camera.orthographic)
        return {.origin = camera.position + camera.world_from_view * glm::dvec3(right, up, 0),
                .direction = -camera.world_from_view[2],
                .begin = camera.near_depth,
                .right = step_right,
                .down = step_down,
                .parallel = true};
    const glm::dvec3 in_view(right, up, -1);
    const double length = glm::length(in_view);
    return {.origin = camera.position,
            .direction = glm::normalize(camera.world_from_view * in_view),
            .begin = camera.near_depth * length,
            .right = step_right / length,
            .down = step_down / length};
}

} // namespace brume::reference
