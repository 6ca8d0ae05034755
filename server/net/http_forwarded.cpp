// Whose a request is that comes through a trusted proxy.
#include <vector>

#include "server/net/http_connection.h"

namespace brume::net {

// One connection of a proxy carries requests of many: each counts for its own visitor, for as long as it takes. A reply
// if that visitor has too many, or comes too often.
std::optional<Reply> HttpConnection::receive(const HttpRequest& request) {
    if (!slot_->forOthers()) return {};
    std::vector<std::string_view> lines;
    const auto [begin, end] = request.equal_range("X-Forwarded-For");
    for (auto line = begin; line != end; ++line) lines.emplace_back(line->value().data(), line->value().size());
    const auto whose = forwardedFor(proxy_, lines, context_->options.trusted_proxies);
    switch (slot_->passTo(whose.text(), whose.network())) {
    case Connections::Refused::full:
        context_->metrics.refused("connections");
        return noRoom();
    case Connections::Refused::rate:
        context_->metrics.refused("accept_rate");
        return tooOften();
    case Connections::Refused::nothing:
        break;
    }
    return {};
}

} // namespace brume::net
