// Key views of a camera as an address has them: path=x,y,z,tx,ty,tz,fov,seconds_x,y,z,...
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/camera_keys.h"

namespace brume::net {

// The key views of the text, none of an empty one; or one line that says which is wrong and what is allowed. They are
// within limits::kCameraKeys. client/web/src/camera-keys.ts writes it.
std::variant<std::vector<CameraKey>, std::string> readPathQuery(std::string_view text);

} // namespace brume::net
