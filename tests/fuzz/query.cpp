#include <algorithm>
#include <cmath>
#include <string>

#include "common/scene_limits.h"
#include "server/net/cloud_query.h"
#include "server/net/origin.h"
#include "server/net/pages.h"
#include "server/net/picture_query.h"
#include "server/net/uri.h"
#include "tests/fuzz/promise.h"

namespace brume::fuzz {
namespace {

void page(std::string_view path) {
    static const net::Pages pages(BRUME_FUZZ_PAGES); // beside it lie files that no path may reach
    const net::Reply reply = pages.serve(path, {});
    promise(reply.status == 200 || reply.status == 404, "a page, or none");
    if (reply.status == 200)
        promise(reply.body.starts_with("a page\n"), "nothing outside the page's folder is served", reply.body);
}

void picture(std::string_view query) {
    static const net::NetOptions options;
    const auto read = net::readPictureQuery(query, options, {{0, 2, 26}, {0, 0, 0}, 0.75f});
    if (const auto* wrong = std::get_if<std::string>(&read)) return promiseOneLine(*wrong, 256);
    const auto& wish = std::get<net::PictureQuery>(read);
    const PoseRequest& request = wish.request;
    promise(std::min(request.width, request.height) >= net::kMinSide &&
                std::max(request.width, request.height) <= options.max_side,
            "a picture's sides within limits");
    promise(uint32_t(request.width) * request.height <= options.max_pixels, "a picture's pixels within limits");
    promise(request.quality >= 1 && request.quality <= 100, "a quality that JPEG has");
    promise(wish.fps > 0 && wish.fps <= options.max_stream_fps, "a rate within limits");
    promise(isUsable(request.pose) && limits::kFovY.holds(request.pose.fov_y), "a pose is usable");
}

void upload(std::string_view query) {
    const auto read = net::readCloudQuery(query);
    if (const auto* wrong = std::get_if<std::string>(&read)) return promiseOneLine(*wrong, 256);
    const auto& wish = std::get<SceneWish>(read);
    promise(net::isFileName(wish.name), "a name that is no path", wish.name);
    promise(!wish.options.unit || limits::kUnit.holds(*wish.options.unit), "a unit within limits");
    if (const auto& origin = wish.options.origin)
        promise(std::max({std::abs(origin->x), std::abs(origin->y), std::abs(origin->z)}) <= limits::kOrigin.hi,
                "an origin within limits");
}

} // namespace

void query(Bytes input) {
    std::string_view text = textOf(input);
    const auto line = [&] {
        const size_t end = std::min(text.find('\n'), text.size());
        const std::string_view first = text.substr(0, end);
        text.remove_prefix(std::min(end + 1, text.size()));
        return first;
    };
    const std::string_view target = line(), origin = line(), host = line();
    const size_t question = std::min(target.find('?'), target.size());
    page(target.substr(0, question));
    picture(target.substr(std::min(question + 1, target.size())));
    upload(target.substr(std::min(question + 1, target.size())));
    if (const auto decoded = net::percentDecode(target))
        promise(decoded->size() <= target.size(), "decoding does not grow");
    if (net::pageAllowed({.host = host, .origin = origin}, {}) && !origin.empty())
        promise(origin.size() > host.size() || host.ends_with(":80") || host.ends_with(":443"),
                "only a page of our own host");
}

} // namespace brume::fuzz
