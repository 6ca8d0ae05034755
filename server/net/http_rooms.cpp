// The part of HttpConnection that opens and closes rooms, and tells of all of them.
#include <fmt/format.h>

#include "server/net/http_connection.h"
#include "server/net/uri.h"

namespace brume::net {
namespace {

constexpr auto kOpenWithin = std::chrono::seconds(60); // with the shaders of its first pictures

// What is wrong with the query, in one line; otherwise the wish.
std::variant<RoomWish, std::string> readRoomQuery(RoomWish::Kind kind, std::string_view query) {
    RoomWish wish{kind, {}, {}};
    const auto fields = parseQuery(query);
    if (!fields) return "the query is not of the form name=value&name=value";
    for (const auto& [name, value] : *fields) {
        if (name == "name")
            wish.name = value;
        else if (name == "scene" && kind == RoomWish::Kind::open)
            wish.scene = value;
        else if (name != "token")
            return "allowed: ?name=NAME" + std::string(kind == RoomWish::Kind::open ? "&scene=SCENE" : "");
    }
    if (!isRoomName(wish.name)) return fmt::format("?name= takes 1 to {} letters, digits, '-' and '_'", kMostRoomName);
    if (kind == RoomWish::Kind::open && wish.scene.empty()) return "?scene= names the scene that the room begins with";
    return wish;
}

} // namespace

// Answers once the room is open, or closed, or with the reason why not.
asio::awaitable<bool> HttpConnection::changeRooms(const HttpRequest& request, std::string_view path,
                                                  std::string_view query) {
    const auto kind = path == "/rooms/open" ? RoomWish::Kind::open : RoomWish::Kind::close;
    auto read = readRoomQuery(kind, query);
    if (const auto* wrong = std::get_if<std::string>(&read))
        co_return co_await send(request, "rooms", lineReply(400, *wrong));
    const auto wish = std::make_shared<RoomRequest>(std::get<RoomWish>(std::move(read)), event_->notifier());
    if (!context_->rooms.requests().push(wish))
        co_return co_await sendLater(request, "rooms", "other rooms are being opened");
    const auto deadline = Clock::now() + kOpenWithin;
    while (!wish->answered() && Clock::now() < deadline && !context_->stopping) co_await event_->wait(deadline);
    if (!wish->answered() && !context_->stopping)
        co_return co_await send(request, "rooms", lineReply(202, "it takes long: /rooms has the room once it is open"));
    if (!wish->answered()) co_return co_await sendLater(request, "rooms", "the server stops");
    if (!wish->complaint().empty()) co_return co_await send(request, "rooms", lineReply(422, wish->complaint()));
    const bool opened = kind == RoomWish::Kind::open;
    Reply reply = lineReply(opened ? 201 : 200, fmt::format("room '{}' is {}", wish->wish.name,
                                                            opened ? "open at /r/" + wish->wish.name + "/" : "closed"));
    reply.headers = {{"Cache-Control", "no-store"}};
    co_return co_await send(request, "rooms", std::move(reply));
}

std::string HttpConnection::metricsText() const {
    if (!room_->name.empty()) return room_->metrics.text(room_->audience);
    std::vector<Metrics::OfRoom> others;
    const std::vector<RoomPtr> rooms = context_->rooms.all(); // they live until the text is made
    for (const RoomPtr& room : rooms)
        if (!room->name.empty()) others.push_back({room->name, room->metrics, room->audience});
    return context_->metrics.text(room_->audience, others);
}

} // namespace brume::net
