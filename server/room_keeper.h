// RoomKeeper: opens and closes the rooms of a server besides the one at "/", on a thread of its own.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/net/rooms.h"
#include "server/room.h"

namespace brume {

class RoomKeeper {
public:
    // Loads the rooms that the options name. `failed`: as of ServedRoom::start(). All but `options` outlive this.
    // Throws std::runtime_error, one line that names the room, if one cannot be loaded.
    RoomKeeper(const ServerOptions& options, const SharedByRooms& shared, std::function<void()> failed);
    // Stops all rooms. The network must have ended.
    ~RoomKeeper();

    // Rooms run, are found, and others are opened and closed as operators wish, from now on.
    void serve(net::Rooms& rooms);
    // No room is opened or closed any more.
    void end();

    // Calls `use` with each room that is open, one at a time.
    void each(const std::function<void(ServedRoom&)>& use);

private:
    struct Kept {
        std::unique_ptr<ServedRoom> served;
        std::weak_ptr<net::Room> found; // who holds it has the room in use
    };

    void run();
    std::string answer(const net::RoomWish& wish);
    std::string open(const std::string& name, const std::string& scene);
    std::string close(const std::string& name);
    std::unique_ptr<ServedRoom> load(const std::string& name, const std::string& scene) const;
    void add(const std::string& name, std::unique_ptr<ServedRoom> served);

    const ServerOptions options_;
    const SharedByRooms shared_;
    const std::function<void()> failed_;
    net::Rooms* rooms_ = nullptr; // null until serve()

    std::mutex kept_mutex_; // guards kept_
    std::map<std::string, Kept> kept_;

    std::mutex mutex_; // guards the next two
    std::condition_variable asked_;
    bool asked_for_ = false, ends_ = false;
    std::thread thread_;
};

} // namespace brume
