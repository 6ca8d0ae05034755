// A replay that is looked at: POST /seek?tick=N.
#include <charconv>

#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include "server/net/http_connection.h"
#include "server/net/uri.h"

namespace brume::net {
namespace {

constexpr auto kSoughtWithin = std::chrono::minutes(1); // steps on the way take about a millisecond

// The query's `tick`; nothing where there is no such number, or another field than it and the token.
std::optional<uint64_t> tickIn(std::string_view query) {
    const auto fields = parseQuery(query);
    if (!fields) return {};
    std::optional<uint64_t> tick;
    for (const auto& [key, value] : *fields) {
        if (key == "token") continue;
        uint64_t number = 0;
        const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
        if (key != "tick" || error != std::errc() || end != value.data() + value.size()) return {};
        tick = number;
    }
    return tick;
}

} // namespace

// Answers once the tick is reached. A later seek replaces one that is under way.
asio::awaitable<bool> HttpConnection::seek(const HttpRequest& request, std::string_view query) {
    ReplayControl* const replay = room_->audience.replay();
    if (!replay)
        co_return co_await send(request, "seek",
                                lineReply(409, "this is no replay: brume-server --replay FILE --look shows one"));
    const std::optional<uint64_t> tick = tickIn(query);
    if (!tick || *tick < replay->first || *tick > replay->last)
        co_return co_await send(
            request, "seek",
            lineReply(400, fmt::format("which tick? /seek?tick=N, N from {} to {}", replay->first, replay->last)));
    const uint64_t number = replay->seek(*tick);
    const auto deadline = Clock::now() + kSoughtWithin;
    while (replay->reached().number < number && Clock::now() < deadline && !context_->stopping)
        co_await event_->wait(std::min(deadline, Clock::now() + std::chrono::milliseconds(5)));
    const ReplayControl::Reached reached = replay->reached();
    if (reached.number > number)
        co_return co_await send(request, "seek", lineReply(409, "another seek came after this one"));
    if (reached.number < number) co_return co_await sendLater(request, "seek", "the tick is not reached yet");
    if (reached.tick != *tick)
        co_return co_await send(
            request, "seek",
            lineReply(500, fmt::format("still at tick {}: the recording cannot be read again, since "
                                       "its file was changed; the log says what is wrong",
                                       reached.tick)));
    Reply reply = lineReply(200, fmt::format("at tick {}", reached.tick));
    reply.headers = {{"Brume-Tick", fmt::format("{}", reached.tick)},
                     {"Brume-State", fmt::format("{:016x}", reached.state_hash)},
                     {"Cache-Control", "no-store"}};
    co_return co_await send(request, "seek", std::move(reply));
}

} // namespace brume::net
