// The query of /snapshot.jpg and /stream.mjpg: ?w=&h=&quality=&position=x,y,z&target=x,y,z&fov=&fps=
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "server/net/options.h"
#include "server/viewer/audience.h"

namespace brume::net {

struct PictureQuery {
    PoseRequest request; // the scene's own camera unless the query places another
    float fps = 30;
};

// The query's values, or one line that says what is wrong and what is allowed.
std::variant<PictureQuery, std::string> readPictureQuery(std::string_view query, const NetOptions& options,
                                                         const SceneFacts& facts);

} // namespace brume::net
