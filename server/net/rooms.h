// Rooms: the scenes of one server, each with its own simulation and its own people. One is at "/", and all that this
// server answers there; the others are at "/r/NAME/", and answer the same.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/metrics/metrics.h"
#include "server/viewer/audience.h"
#include "server/viewer/requests.h"

namespace brume::net {

inline constexpr size_t kMostRoomName = 32; // letters, digits, '-' and '_'
bool isRoomName(std::string_view name);

// The URL of a room of the server at `url`, which is that of its page or socket, with or without a slash at its end.
// `room`: empty for the one at "/".
std::string roomUrl(const std::string& url, std::string_view room);

// Where viewers go that a room does not keep. Thread-safe.
class Elsewhere {
public:
    // `url` is called from any thread, under a lock: after this call the one before is not called any more.
    void set(std::function<std::string()> url) {
        const std::scoped_lock lock(mutex_);
        url_ = std::move(url);
    }
    // Of the server with the most room; empty if there is none.
    std::string url() const {
        const std::scoped_lock lock(mutex_);
        return url_ ? url_() : std::string();
    }

private:
    mutable std::mutex mutex_;
    std::function<std::string()> url_;
};

// A room for as long as somebody holds it.
struct Room {
    Room(std::string own_name, Audience& people, Metrics& counts)
        : name(std::move(own_name)), audience(people), metrics(counts) {}

    const std::string name; // empty: the one at "/"
    Audience& audience;
    Metrics& metrics;
    Elsewhere elsewhere{};

    // Where viewers go when the server stops. `given`: the URL of a server that all are sent to, each to the same room;
    // empty: elsewhere.url().
    std::string goTo(const std::string& given) const;
};
using RoomPtr = std::shared_ptr<Room>;

// What a request's path names: a room, and the path in it.
struct RoomPath {
    std::string_view room; // empty: the one at "/"
    std::string_view path; // begins with "/"; empty: it names a room without the "/" behind it
};
RoomPath roomPathOf(std::string_view path);

// A wish of operators to open or to close a room.
struct RoomWish {
    enum class Kind { open, close } kind;
    std::string name, scene; // scene: of a room that is opened
};
class RoomRequest {
public:
    // `notify`: called once by the thread that answers.
    RoomRequest(RoomWish of, std::function<void()> notify) : wish(std::move(of)), notify_(std::move(notify)) {}

    const RoomWish wish;

    // One line; empty: it is done.
    void answer(std::string complaint) {
        complaint_ = std::move(complaint);
        answered_ = true;
        notify_();
    }
    bool answered() const { return answered_; }
    const std::string& complaint() const { return complaint_; } // Precondition: answered()

private:
    const std::function<void()> notify_;
    std::string complaint_;
    std::atomic<bool> answered_{false};
};

// Thread-safe.
class Rooms {
public:
    explicit Rooms(RoomPtr home) : home_(std::move(home)) {}

    const RoomPtr& home() const { return home_; }
    // Null: there is none of that name.
    RoomPtr find(std::string_view name) const;
    std::vector<RoomPtr> all() const; // the one at "/" first, then by name
    // Precondition: the name is free.
    void add(RoomPtr room);
    // Nobody finds it any more; who holds it keeps it.
    void remove(std::string_view name);

    Requests<RoomRequest>& requests() { return requests_; }

private:
    const RoomPtr home_;
    mutable std::mutex mutex_;
    std::map<std::string, RoomPtr, std::less<>> others_;
    Requests<RoomRequest> requests_;
};

// For people and programs: {"rooms": [{"name": "", "href": "./", "scene": "cloud", "viewers": 3, ...}]}. Addresses are
// relative to the page at "/".
std::string roomsJson(const Rooms& rooms);

} // namespace brume::net
