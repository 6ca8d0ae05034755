#include "server/net/rooms.h"

#include <algorithm>
#include <cctype>

#include <nlohmann/json.hpp>

namespace brume::net {

bool isRoomName(std::string_view name) {
    return !name.empty() && name.size() <= kMostRoomName && std::ranges::all_of(name, [](unsigned char c) {
        return c < 0x80 && (std::isalnum(c) || c == '-' || c == '_');
    });
}

// As clients read it: a last part without a dot is a folder whose slash was left out, unless it is a socket.
std::string roomUrl(const std::string& url, std::string_view room) {
    if (url.empty() || room.empty()) return url;
    std::string folder = url.substr(0, url.find_first_of("?#"));
    const std::string behind = url.substr(folder.size());
    const size_t path = folder.find('/', folder.find("://") + 3);
    if (path == folder.npos) folder += '/';
    const bool socket = folder.starts_with("ws");
    const std::string last = folder.substr(folder.rfind('/') + 1);
    if (!socket && last != "ws" && !last.empty() && last.find('.') == last.npos)
        folder += '/';
    else
        folder.resize(folder.size() - last.size());
    return folder + "r/" + std::string(room) + (socket ? "/ws" : "/") + behind;
}

std::string Room::goTo(const std::string& given) const {
    return given.empty() ? elsewhere.url() : roomUrl(given, name);
}

RoomPath roomPathOf(std::string_view path) {
    constexpr std::string_view kBegin = "/r/";
    if (!path.starts_with(kBegin)) return {{}, path};
    const std::string_view rest = path.substr(kBegin.size());
    const std::string_view name = rest.substr(0, rest.find('/'));
    if (!isRoomName(name)) return {{}, path};
    return {name, rest.substr(name.size())};
}

RoomPtr Rooms::find(std::string_view name) const {
    if (name.empty()) return home_;
    const std::scoped_lock lock(mutex_);
    const auto found = others_.find(name);
    return found == others_.end() ? nullptr : found->second;
}

std::vector<RoomPtr> Rooms::all() const {
    std::vector<RoomPtr> rooms{home_};
    const std::scoped_lock lock(mutex_);
    for (const auto& [name, room] : others_) rooms.push_back(room);
    return rooms;
}

void Rooms::add(RoomPtr room) {
    const std::scoped_lock lock(mutex_);
    others_[room->name] = std::move(room);
}

void Rooms::remove(std::string_view name) {
    const std::scoped_lock lock(mutex_);
    if (const auto found = others_.find(name); found != others_.end()) others_.erase(found);
}

std::string roomsJson(const Rooms& rooms) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const RoomPtr& room : rooms.all()) {
        const auto report = room->audience.report();
        list.push_back({{"name", room->name},
                        {"href", room->name.empty() ? "./" : "r/" + room->name + "/"},
                        {"scene", room->audience.scene()->scene.name},
                        {"viewers", room->audience.size()},
                        {"particles", report->particles},
                        {"tick", report->tick},
                        {"ready", room->audience.ready.load()}});
    }
    return nlohmann::ordered_json{{"rooms", std::move(list)}}.dump() + "\n";
}

} // namespace brume::net
