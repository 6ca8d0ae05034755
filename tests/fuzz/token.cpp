#include "server/net/token.h"

#include "server/net/access.h"
#include "server/net/rooms.h"
#include "tests/fuzz/promise.h"

namespace brume::fuzz {

// A token as a browser sends it, a payload alone, and a request's query; whatever is let through keeps its limits.
void token(Bytes input) {
    using namespace std::chrono;
    static const std::string key(net::kLeastKeyBytes, 'k');
    static const net::Seconds now{seconds(1'800'000'000)};
    const std::string_view text = textOf(input);

    const auto read = net::readToken(text, key, now);
    if (const auto* fault = std::get_if<net::TokenFault>(&read)) {
        promiseOneLine(*fault, 128);
    } else {
        const auto& claims = std::get<net::Claims>(read);
        promise(text.size() <= net::kMostTokenBytes, "a token is short");
        promise(claims.expires + net::kClockSkew > now, "a token that has expired is none");
        promise(claims.expires <= now + net::kLongestToken + net::kClockSkew, "a token is short-lived");
    }

    // Fuzzing does not find signatures: what they would protect is read without.
    const std::string_view payload = text.substr(0, text.find('.'));
    if (const auto claims = net::readClaims(payload)) {
        promise(claims->role >= net::Role::viewer && claims->role <= net::Role::operator_, "a role that there is");
        promise(claims->expires.time_since_epoch().count() >= 0, "a time after 1970");
        promise(claims->name.size() <= net::kMostTokenName, "a name is short");
        if (!claims->name.empty()) promiseOneLine(claims->name, net::kMostTokenName);
        promise(claims->room.empty() || net::isRoomName(claims->room), "a room has a room's name");
        const std::string made = net::makeToken(*claims, key);
        const auto again = net::readToken(made, key, claims->expires);
        const auto* same = std::get_if<net::Claims>(&again);
        promise(made.size() <= net::kMostTokenBytes, "what is made can be read", made);
        promise(same && same->role == claims->role && same->expires == claims->expires && same->name == claims->name &&
                    same->room == claims->room,
                "what is made says the same", made);
    }

    net::NetOptions options;
    options.token_key = key;
    for (const auto& [authorization, query] : {std::pair{text, std::string_view()}, {std::string_view(), text}}) {
        const auto checked = net::authorize(authorization, query, net::Role::viewer, options);
        const auto* refusal = std::get_if<net::Reply>(&checked);
        promise(refusal && refusal->status == 401, "nobody comes in without a token of now");
    }
}

} // namespace brume::fuzz
