#include "server/room_keeper.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/last_line.h"

namespace brume {
namespace {

constexpr std::chrono::seconds kEmptiesWithin{5}; // connections of a room that is closed
constexpr std::chrono::milliseconds kLook{20};
constexpr char kClosed[] = "this room was closed";

} // namespace

RoomKeeper::RoomKeeper(const ServerOptions& options, const SharedByRooms& shared, std::function<void()> failed)
    : options_(options), shared_(shared), failed_(std::move(failed)) {
    for (const std::string& one : options_.rooms) {
        const size_t end = one.find('=');
        const std::string name = one.substr(0, end), scene = one.substr(end + 1);
        if (kept_.contains(name)) throw std::runtime_error("--room " + one + ": there is a room of that name already");
        if (kept_.size() >= options_.max_rooms)
            throw std::runtime_error(fmt::format("--room {}: --max-rooms allows {}", one, options_.max_rooms));
        try {
            kept_[name].served = load(name, scene);
        } catch (const std::exception& error) {
            throw std::runtime_error("--room " + one + ": " + lastLine(error));
        }
    }
}

RoomKeeper::~RoomKeeper() { end(); }

void RoomKeeper::serve(net::Rooms& rooms) {
    rooms_ = &rooms;
    for (auto& [name, kept] : kept_) add(name, std::move(kept.served));
    rooms.requests().serve([this] {
        const std::scoped_lock lock(mutex_);
        asked_for_ = true;
        asked_.notify_one();
    });
    thread_ = std::thread([this] { run(); });
}

void RoomKeeper::end() {
    if (!thread_.joinable()) return;
    rooms_->requests().serve(nullptr);
    {
        const std::scoped_lock lock(mutex_);
        ends_ = true;
    }
    asked_.notify_one();
    thread_.join();
}

void RoomKeeper::run() {
    for (;;) {
        {
            std::unique_lock lock(mutex_);
            asked_.wait(lock, [&] { return ends_ || asked_for_; });
            if (ends_) return;
            asked_for_ = false;
        }
        while (const auto request = rooms_->requests().take()) request->answer(answer(request->wish));
    }
}

void RoomKeeper::each(const std::function<void(ServedRoom&)>& use) {
    const std::scoped_lock lock(kept_mutex_);
    for (auto& [name, kept] : kept_)
        if (kept.served) use(*kept.served);
}

std::unique_ptr<ServedRoom> RoomKeeper::load(const std::string& name, const std::string& scene) const {
    const ServerOptions options = optionsOfRoom(options_, name, scene);
    return std::make_unique<ServedRoom>(name, options, shared_, loadScene(options));
}

// Precondition: the name is free, or an entry that holds nothing.
void RoomKeeper::add(const std::string& name, std::unique_ptr<ServedRoom> served) {
    auto room = std::make_shared<net::Room>(name, served->audience(), served->metrics());
    if (cluster::Node* const node = served->node()) room->elsewhere.set([node] { return node->elsewhere(); });
    {
        const std::scoped_lock lock(kept_mutex_); // who is woken meanwhile finds it
        served->start(failed_);
        spdlog::info("room '{}' is open: scene '{}'", name, served->scene().name);
        kept_[name] = {std::move(served), room};
    }
    rooms_->add(std::move(room));
}

std::string RoomKeeper::answer(const net::RoomWish& wish) {
    if (!options_.cluster.engine.servers.empty())
        return "one of several servers: their rooms are those that --room names";
    return wish.kind == net::RoomWish::Kind::open ? open(wish.name, wish.scene) : close(wish.name);
}

std::string RoomKeeper::open(const std::string& name, const std::string& scene) {
    {
        const std::scoped_lock lock(kept_mutex_);
        if (kept_.contains(name)) return fmt::format("there is a room '{}' already", name);
        if (kept_.size() >= options_.max_rooms)
            return fmt::format("there are {} rooms, as many as --max-rooms allows: close one", kept_.size());
    }
    const std::vector<std::string> scenes = otherScenes(options_);
    if (std::ranges::find(scenes, scene) == scenes.end()) // operators name scenes, not files of this machine
        return fmt::format("no scene '{}'; there are: {}", scene, fmt::join(scenes, ", "));
    try {
        add(name, load(name, std::filesystem::absolute(fileOfScene(options_, scene)).string()));
        return {};
    } catch (const std::exception& error) {
        spdlog::error("room '{}' is not opened: {}", name, lastLine(error));
        return lastLine(error);
    }
}

// Its viewers are told, and nobody finds it any more. It is gone once no connection holds it.
std::string RoomKeeper::close(const std::string& name) {
    std::weak_ptr<net::Room> found;
    {
        const std::scoped_lock lock(kept_mutex_);
        const auto one = kept_.find(name);
        if (one == kept_.end()) return fmt::format("there is no room '{}'", name);
        found = one->second.found;
    }
    rooms_->remove(name);
    const auto deadline = Clock::now() + kEmptiesWithin;
    while (const auto room = found.lock()) {
        std::vector<std::shared_ptr<Viewer>> viewers;
        room->audience.list(viewers);
        for (const auto& viewer : viewers)
            if (viewer->refusal().empty()) viewer->refuse(kClosed);
        if (Clock::now() > deadline)
            return fmt::format("room '{}' is closed to all, but a connection goes on: try again", name);
        std::this_thread::sleep_for(kLook);
    }
    Kept kept;
    {
        const std::scoped_lock lock(kept_mutex_);
        kept = std::move(kept_.extract(name).mapped());
    }
    kept.served.reset();
    spdlog::info("room '{}' is closed", name);
    return {};
}

} // namespace brume
