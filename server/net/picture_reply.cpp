#include "server/net/picture_reply.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace brume::net {

const char* contentTypeOf(const EncodedFrame& frame) {
    if (frame.request.alpha == Alpha::exr) return "image/x-exr";
    return frame.png ? "image/png" : "image/jpeg";
}

std::vector<std::pair<std::string, std::string>> headersOf(const EncodedFrame& frame, const PictureQuery& query) {
    const PoseRequest& request = frame.request;
    std::vector<std::pair<std::string, std::string>> headers{
        {"Brume-Tick", fmt::format("{}", frame.tick)},
        {"Brume-State", fmt::format("{:016x}", frame.state_hash)},
        {"Brume-Size", fmt::format("{}x{}", request.width, request.height)},
        {"Brume-Error", fmt::format("{:.4g}", frame.error)}};
    if (request.width != query.asked_width || request.height != query.asked_height)
        headers.emplace_back("Brume-Asked", fmt::format("{}x{}", query.asked_width, query.asked_height));
    return headers;
}

void tellIgnored(const PictureQuery& query, Reply& reply) {
    if (!query.ignored.empty())
        reply.headers.emplace_back("Brume-Ignored", fmt::format("{}", fmt::join(query.ignored, " ")));
}

} // namespace brume::net
