#include "server/net/picture_query.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "common/scene_limits.h"
#include "common/view_names.h"
#include "server/net/picture_size.h"
#include "server/net/uri.h"

namespace brume::net {
namespace {

// Decimal numbers, separated by commas, exactly `count` of them, each within limits.
bool readNumbers(std::string_view text, float* out, int count, Limits allowed) {
    for (int i = 0; i < count; ++i) {
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), out[i]);
        if (error != std::errc() || !allowed.holds(out[i])) return false;
        text.remove_prefix(size_t(end - text.data()));
        if (i + 1 == count) return text.empty();
        if (!text.starts_with(',')) return false;
        text.remove_prefix(1);
    }
    return false;
}

constexpr size_t kMostTold = 8, kLongestTold = 32; // numbers of parameters that nothing reads, and of their letters

// As it may stand in a header.
std::string plainName(std::string_view name) {
    std::string plain(name.substr(0, kLongestTold));
    std::ranges::replace_if(
        plain, [](unsigned char c) { return !std::isalnum(c) && c != '_' && c != '-' && c != '.'; }, '?');
    return plain;
}

} // namespace

std::variant<PictureQuery, std::string> readPictureQuery(std::string_view query, const NetOptions& options,
                                                         SceneCamera camera) {
    const auto fields = parseQuery(query);
    if (!fields) return "the query is not of the form name=value&name=value";

    PictureQuery out;
    bool alpha = false;
    float width = 0, height = 0, quality = options.default_quality; // 0: not given
    for (const auto& [name, value] : *fields) {
        const auto number = [&, &text = value](float& into, Limits allowed) {
            return readNumbers(text, &into, 1, allowed);
        };
        const auto refuse = [&, &what = name](const std::string& allowed) {
            return fmt::format("{} must be {}", what, allowed);
        };
        const auto range = [&](Limits allowed) { return refuse(fmt::format("{} ... {}", allowed.lo, allowed.hi)); };
        const auto whole = [&](float& into, Limits allowed) {
            return number(into, allowed) && into == std::floor(into);
        };
        const auto wholes = [&](Limits allowed) {
            return refuse(fmt::format("a whole number, {} ... {}", allowed.lo, allowed.hi));
        };
        const auto place = [&] {
            return refuse(fmt::format("x,y,z in metres, each {} ... {}", limits::kPlace.lo, limits::kPlace.hi));
        };
        const Limits side{kMinSide, double(options.max_side)}, rate{0.1, options.max_stream_fps}, jpeg{1, 100};
        if (name == "w") {
            if (!whole(width, side)) return wholes(side);
        } else if (name == "h") {
            if (!whole(height, side)) return wholes(side);
        } else if (name == "quality") {
            if (!whole(quality, jpeg)) return wholes(jpeg);
            out.has_quality = true;
        } else if (name == "fps") {
            if (!number(out.fps, rate)) return range(rate);
        } else if (name == "fov") {
            if (!number(camera.fov_y, limits::kFovY)) return range(limits::kFovY) + " radians, from bottom to top";
        } else if (name == "position") {
            if (!readNumbers(value, &camera.position.x, 3, limits::kPlace)) return place();
        } else if (name == "target") {
            if (!readNumbers(value, &camera.target.x, 3, limits::kPlace)) return place();
        } else if (name == "format") {
            if (value != "jpeg" && value != "png" && value != "exr") return refuse("jpeg, png or exr");
            out.request.lossless = value == "png";
            if (value == "exr") out.request.alpha = Alpha::exr;
        } else if (name == "alpha") {
            if (value != "0" && value != "1") return refuse("0 or 1");
            alpha = value == "1";
        } else if (name == "keep_size") {
            if (value != "0" && value != "1") return refuse("0 or 1");
            out.request.keeps_size = value == "1";
        } else if (name == "views") {
            if (value != "1") return refuse("1: a JPEG shows one eye; both come over the WebSocket");
        } else if (name == "view") {
            const auto view = viewNamed(value);
            if (!view) return refuse("one of " + allViewNames());
            out.request.show = *view;
        } else if (name != "token") { // `token` is read by the access check (access.h)
            if (out.ignored.size() < kMostTold) out.ignored.push_back(plainName(name));
        }
    }
    if (alpha && out.request.alpha == Alpha::none) out.request.alpha = Alpha::png;
    if (glm::distance(camera.position, camera.target) < 1e-3f) return "position and target must differ";

    // One side alone keeps the shape of the default size.
    const float shape = float(options.default_width) / float(options.default_height);
    if (width == 0) width = height == 0 ? options.default_width : std::round(height * shape);
    if (height == 0) height = std::round(width / shape);
    out.asked_width = uint32_t(width), out.asked_height = uint32_t(height);
    const PictureSize size = fitSize({uint16_t(width), uint16_t(height)}, options);
    out.camera = camera;
    out.request.seq = 1;
    out.request.width = size.width;
    out.request.height = size.height;
    out.request.quality = uint8_t(quality);
    out.request.pose = lookAt(camera.position, camera.target, camera.fov_y);
    return out;
}

} // namespace brume::net
