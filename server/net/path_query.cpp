#include "server/net/path_query.h"

#include <charconv>

#include <fmt/format.h>

#include "common/scene_limits.h"

namespace brume::net {
namespace {

bool readKey(std::string_view text, CameraKey& key, bool first) {
    float numbers[8]{};
    for (float& number : numbers) {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (error != std::errc()) return false;
        text.remove_prefix(size_t(end - text.data()));
        const bool last = &number == std::end(numbers) - 1;
        if (last ? !text.empty() : !text.starts_with(',')) return false;
        if (!last) text.remove_prefix(1);
    }
    for (int i = 0; i < 6; ++i)
        if (!limits::kPlace.holds(double(numbers[i]))) return false;
    key = {{numbers[0], numbers[1], numbers[2]}, {numbers[3], numbers[4], numbers[5]}, numbers[6], numbers[7]};
    return glm::distance(key.position, key.target) > 1e-3f && limits::kFovY.holds(double(key.fov_y)) &&
           (first ? key.seconds == 0 : limits::kKeySeconds.holds(double(key.seconds)));
}

} // namespace

std::variant<std::vector<CameraKey>, std::string> readPathQuery(std::string_view text) {
    std::vector<CameraKey> keys;
    while (!text.empty()) {
        if (double(keys.size()) >= limits::kCameraKeys.hi)
            return fmt::format("path has at most {} key views", limits::kCameraKeys.hi);
        const size_t end = text.find('_');
        const bool first = keys.empty();
        if (!readKey(text.substr(0, end), keys.emplace_back(), first) || end + 1 == text.size())
            return fmt::format("key view {} of path must be x,y,z,tx,ty,tz,fov,seconds: places of {} ... {} m that "
                               "differ, {} ... {} rad, {} ... {} s, of the first 0",
                               keys.size(), limits::kPlace.lo, limits::kPlace.hi, limits::kFovY.lo, limits::kFovY.hi,
                               limits::kKeySeconds.lo, limits::kKeySeconds.hi);
        text = end == text.npos ? std::string_view() : text.substr(end + 1);
    }
    return keys;
}

} // namespace brume::net
