// What viewers may ask of the shared scene. Commands are taken in order at a tick and stamped with it.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <glm/glm.hpp>

#include "common/settings.h"
#include "server/sim/particle_rows.h"

namespace brume {

struct Impulse {                              // pushes particles near the ray away from it and along it
    glm::vec3 origin{0}, direction{0, 0, -1}; // direction has any length but 0
    glm::vec3 push{0};                        // m/s per unit of strength; zero means: away from the ray
    float strength = 1;                       // times the scene's impulse_strength, in [-10, 10]
};
struct MoveVolume {
    glm::vec3 offset{0}; // m, added to the volume's place
};
struct Set { // gives live settings new values
    Set() = default;
    Set(std::initializer_list<Change> all) : changes(all) {}

    std::vector<Change> changes; // made in this order
};
struct Restart {};
struct Add { // a light or a fog, after those that there are
    SceneList list = SceneList::fogs;
    std::vector<Change>
        changes; // of the new element, which begins with the defaults of a scene file; a light is a point
};
struct Remove { // the elements behind it move up
    SceneList list = SceneList::fogs;
    uint32_t element = 0;
};

struct Undo {               // takes back the newest change that can be: Set, Add, Remove or MoveVolume
    bool operators = false; // True: who asks may take back what only operators change
};

using CommandBody = std::variant<Impulse, MoveVolume, Set, Restart, SetParticles, Add, Remove, Undo>;

struct Command {
    uint32_t viewer = 0; // who asked
    uint32_t seq = 0;    // the viewer's own number
    CommandBody body;
    std::chrono::steady_clock::time_point received{}; // by CommandQueue; 0: never, as those of recordings
};

// Predicted for one picture, in ms.
struct ListPrices {
    double left = std::numeric_limits<double>::infinity(); // time for more elements
    double light = 0, shadowed_light = 0;                  // time of one more light, without shadows and with
    double plane = 0, body = 0;                            // time of one more plane, of one more box or sphere
    double growth = 0; // time that a box or sphere takes more which grows until all rays are in its shadow
};

inline constexpr uint32_t kMostImpulses = 64; // in a tick: each is a pass over all particles
// Of SetParticles in a tick: a million rows with albedos, which a sender may push as fast as its link allows.
inline constexpr size_t kMostRowBytes = 32u << 20;

// Many writers, one reader, which drains it once a tick. It refuses what the next tick cannot take, so that the
// writer can answer its viewer: nothing is dropped silently.
class CommandQueue {
public:
    explicit CommandQueue(size_t capacity = 4096) : capacity_(capacity) { pending_.reserve(capacity); }
    // False if the queue is full, if the command is an impulse and kMostImpulses wait already, or if rows of particles
    // would exceed kMostRowBytes.
    // False, too, while the queue is closed, and if the command adds more lights or objects than there is time for:
    // until price() is called again, each takes its part of it.
    [[nodiscard]] bool push(Command command) {
        const bool impulse = std::holds_alternative<Impulse>(command.body);
        const auto* particles = std::get_if<SetParticles>(&command.body);
        const size_t bytes = particles ? particles->rows->bytes() : 0;
        const std::scoped_lock lock(mutex_);
        const double price = priceOf(command.body);
        if (price > prices_.left) return false;
        if (closed_ || pending_.size() >= capacity_ || (impulse && impulses_ >= kMostImpulses) ||
            row_bytes_ + bytes > kMostRowBytes)
            return false;
        prices_.left -= price;
        priced_out_ = priced_out_ || price > 0;
        impulses_ += impulse;
        row_bytes_ += bytes;
        command.received = std::chrono::steady_clock::now();
        pending_.push_back(std::move(command));
        if (wake_) wake_();
        return true;
    }
    bool empty() const {
        const std::scoped_lock lock(mutex_);
        return pending_.empty();
    }
    // Refuses commands from now on, for the reason `why`: one line that outlives the queue. Null: takes them again.
    void close(const char* why) {
        const std::scoped_lock lock(mutex_);
        closed_ = why;
    }
    // Null: it takes commands.
    const char* closed() const {
        const std::scoped_lock lock(mutex_);
        return closed_;
    }
    // What lights and objects cost from now on, and how much time is left for them.
    void price(const ListPrices& prices) {
        const std::scoped_lock lock(mutex_);
        prices_ = prices;
        priced_out_ = false;
    }
    // True: the reader has all commands that took a part of what was left, and may price anew.
    bool isPricedOut() const {
        const std::scoped_lock lock(mutex_);
        return priced_out_ && pending_.empty();
    }
    // Of a command that push() refuses for its price, in ms of a picture: what it takes, and what is left.
    struct TooDear {
        double price, left;
    };
    std::optional<TooDear> tooDear(const CommandBody& body) const {
        const std::scoped_lock lock(mutex_);
        const TooDear answer{priceOf(body), prices_.left};
        return answer.price > answer.left ? std::optional(answer) : std::nullopt;
    }
    // `wake` is called after each push, with a lock held: it may not use the queue. Null: nobody is told.
    void serve(std::function<void()> wake) {
        const std::scoped_lock lock(mutex_);
        wake_ = std::move(wake);
    }
    // Swaps the pending commands into `out`, which is cleared first; the two buffers keep their capacity.
    void drain(std::vector<Command>& out) {
        out.clear();
        const std::scoped_lock lock(mutex_);
        std::swap(out, pending_);
        impulses_ = 0;
        row_bytes_ = 0;
    }

private:
    // Of what it adds, of the shadows that it gives to lights, and of bodies' sizes: each may grow as far as it can.
    double priceOf(const CommandBody& body) const {
        const auto shadows = [](const Change& change) -> std::optional<bool> {
            if (change.setting->path != "light.shadows") return {};
            return std::get<bool>(change.value);
        };
        const auto growth = [&](const Change& change) {
            const std::string_view path = change.setting->path;
            return path == "box.size" || path == "sphere.radius" ? prices_.growth : 0;
        };
        if (const auto* added = std::get_if<Add>(&body)) {
            if (added->list == SceneList::fogs) return 0; // there are few
            if (added->list == SceneList::planes) return prices_.plane;
            double price = prices_.body;
            for (const Change& change : added->changes) price += growth(change);
            if (added->list != SceneList::lights) return price;
            bool has = true;
            for (const Change& change : added->changes) has = shadows(change).value_or(has);
            return has ? prices_.shadowed_light : prices_.light;
        }
        double price = 0;
        const auto* set = std::get_if<Set>(&body);
        for (const Change& change : set ? std::span(set->changes) : std::span<const Change>()) {
            if (shadows(change).value_or(false)) price += std::max(prices_.shadowed_light - prices_.light, 0.0);
            price += growth(change);
        }
        return price;
    }

    mutable std::mutex mutex_;
    std::function<void()> wake_;
    const char* closed_ = nullptr;
    ListPrices prices_;
    bool priced_out_ = false; // True: commands took a part of prices_.left
    size_t capacity_;
    std::vector<Command> pending_;
    uint32_t impulses_ = 0; // in pending_
    size_t row_bytes_ = 0;  // of all rows in pending_
};

// Why it refuses a command, in one line.
inline std::string whyRefused(const CommandQueue& queue, const CommandBody& body) {
    const char* const closed = queue.closed();
    if (const auto dear = closed ? std::nullopt : queue.tooDear(body))
        return fmt::format("with more a picture would take {:.0f} ms longer, and {:.0f} are left: remove a light or an "
                           "object first, or add lights without shadows; the server's --most-frame-time bounds it",
                           dear->price, dear->left);
    return closed ? closed : "too many commands wait: try again";
}

} // namespace brume
