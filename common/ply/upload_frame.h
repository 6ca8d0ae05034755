// How an uploaded file's places become those of its scene, where who uploads it leaves that open.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/ply/ply.h"

namespace brume {

// What who uploads a file says of it.
struct UploadOptions {
    std::optional<double> unit; // m, of the file's lengths; nothing: the file's are metres, unless they cannot be seen
    std::string up = "y";       // as PlyFrame::up
    std::optional<glm::dvec3> origin; // m; nothing: near the points
    bool keep_far = false;            // True: points that are far from all others are kept
};

struct UploadFrame {
    double unit = 1;                // m
    glm::dvec3 origin{0};           // m
    std::vector<std::string> notes; // what was chosen, one line each

    // The frame for points that lie there. Throws SceneError where no origin is near enough to them, and
    // where no unit shows them.
    UploadFrame(const PlyExtent& extent, const UploadOptions& options);
};

} // namespace brume
