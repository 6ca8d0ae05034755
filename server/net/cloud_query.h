// The query of an upload: /cloud?name=smoke&unit=mm&up=z&origin=auto&far_points=keep.
#pragma once

#include <string>
#include <string_view>
#include <variant>

#include "server/viewer/scene_requests.h"

namespace brume::net {

// Letters, digits, - and _, 1 to 40 of them: what a scene's file is called.
bool isFileName(std::string_view name);

// The wish without its points, or one line that says what the query may be.
std::variant<SceneWish, std::string> readCloudQuery(std::string_view query);

} // namespace brume::net
