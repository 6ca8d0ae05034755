// Camera: the rays of a picture, one for each pixel.
#pragma once

#include "common/camera.h"
#include "tools/reference/world.h"

namespace brume::reference {

struct Camera {
    int width = 1, height = 1; // pixels
    glm::dvec3 position{0};
    glm::dmat3 world_from_view{1};
    bool orthographic = false;
    double half_height = 0.5; // half the picture's height: m if orthographic, otherwise m per m of view depth
    double near_depth = 0;    // m, view depth of the near plane; nothing in front of it is seen
};

Camera perspective(const Pose& pose, int width, int height, double near_depth = 0);
// `height_m`: height of the whole picture, m.
Camera orthographic(const Pose& pose, int width, int height, double height_m);

// The ray through pixel coordinates (x right, y down; a pixel's centre is at +0.5).
Ray rayThrough(const Camera& camera, double x, double y);

} // namespace brume::reference
