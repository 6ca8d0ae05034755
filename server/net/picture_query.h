// The query of /snapshot.jpg, /snapshot.png, /snapshot.exr and /stream.mjpg:
// ?w=&h=&quality=&position=x,y,z&target=x,y,z&fov=&fps=&keep_size=&view=&format=&alpha=
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "server/net/options.h"
#include "server/viewer/audience.h"

namespace brume::net {

struct PictureQuery {
    PoseRequest request; // `camera`'s view unless the query places another
    SceneCamera camera;  // the same view
    float fps = 30;
    bool has_quality = false;         // true: the query has a quality; else the request's is the server's
    std::vector<std::string> ignored; // parameters that nothing reads, as they may stand in a header; eight at most
    uint32_t asked_width = 0, asked_height = 0; // pixels; the request's are fewer where the server allows fewer
};

// The query's values, or one line that says what is wrong and what is allowed. What has no meaning here is passed over:
// many programs add a parameter so that nothing between keeps the picture.
std::variant<PictureQuery, std::string> readPictureQuery(std::string_view query, const NetOptions& options,
                                                         SceneCamera camera);

} // namespace brume::net
