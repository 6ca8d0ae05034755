#include "server/net/access.h"

#include <fmt/format.h>

#include "server/net/uri.h"

namespace brume::net {
namespace {

constexpr std::string_view kScheme = "bearer ";

bool startsWithScheme(std::string_view text) {
    if (text.size() < kScheme.size()) return false;
    for (size_t i = 0; i < kScheme.size(); ++i)
        if ((text[i] >= 'A' && text[i] <= 'Z' ? char(text[i] - 'A' + 'a') : text[i]) != kScheme[i]) return false;
    return true;
}

std::string tokenOf(std::string_view authorization, std::string_view query) {
    if (startsWithScheme(authorization)) return std::string(authorization.substr(kScheme.size()));
    const auto fields = parseQuery(query);
    if (!fields) return {};
    const auto found = fields->find("token");
    return found == fields->end() ? std::string() : found->second;
}

Reply unauthorized(std::string line) {
    Reply reply = lineReply(401, std::move(line));
    reply.headers = {{"WWW-Authenticate", "Bearer realm=\"brume\""}, {"Cache-Control", "no-store"}};
    return reply;
}

} // namespace

std::string forbidden(Role role, Role least) {
    return fmt::format("role {} may not do that: it takes {}", nameOf(role), nameOf(least));
}

std::variant<Authorization, Reply> authorize(std::string_view header, std::string_view query, Role least,
                                             const NetOptions& options, std::string_view room) {
    if (options.token_key.empty()) return Authorization{};
    const std::string token = tokenOf(header, query);
    if (token.empty()) return unauthorized("a token is needed: ask who runs this server for one");
    const auto now = std::chrono::system_clock::now();
    const auto read = readToken(token, options.token_key, std::chrono::floor<std::chrono::seconds>(now));
    if (const auto* fault = std::get_if<TokenFault>(&read)) return unauthorized(*fault);
    const auto& claims = std::get<Claims>(read);
    if (!claims.room.empty() && claims.room != room)
        return lineReply(403, fmt::format("this token is good in the room '{0}' alone: below /r/{0}/", claims.room));
    if (!atLeast(claims.role, least)) return lineReply(403, forbidden(claims.role, least));
    const auto left = claims.expires + kClockSkew - now;
    return Authorization{claims.role, Clock::now() + std::chrono::duration_cast<Clock::duration>(left), claims.name};
}

} // namespace brume::net
