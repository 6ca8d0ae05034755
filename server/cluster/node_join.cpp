// How a server joins the log, verifies that it is still the same one, and joins anew.
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/cluster/identity.h"
#include "server/cluster/node.h"

namespace brume::cluster {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kGone{2000};  // the log is not found: it may be that its servers choose a leader
constexpr milliseconds kWhole{4000}; // for a whole snapshot, besides twice the time between two

} // namespace

// What `asks` returns. It is called again when the engine does not answer, for as long as the options allow: NATS
// servers that start together choose a leader first, and a store that is just being made does not answer yet.
template <class Asks>
auto Node::askedAgain(const Asks& asks) const {
    for (const auto until = Clock::now() + options_.engine.timeout;; std::this_thread::sleep_for(kTryAgain)) {
        try {
            return asks();
        } catch (const EngineAway&) {
            if (Clock::now() >= until) throw;
        }
    }
}

Node::Node(const ClusterOptions& options, const Scene& scene, const std::string& scene_text,
           const std::vector<std::string>& overrides, uint64_t memory, Audience& audience)
    : options_(options), audience_(audience), engine_(options.engine, [this] { wake(); }), snapshots_(engine_),
      handover_(
          [this](SavedState state) {
              const std::scoped_lock lock(mutex_);
              saved_ = std::move(state);
              woken_.notify_all();
          },
          [this](uint64_t tick) {
              if (tick % kTellEvery != 0) return;
              const std::scoped_lock lock(mutex_);
              passed_ = tick;
              awake_ = true;
              woken_.notify_all();
          }) {
    try {
        Simulation simulation(scene, memory);
        simulation.save(start_);
        const Identity own = identityOf(simulation, scene.name, scene_text, overrides);
        const Engine::LogInfo found = open(textOf(own));
        if (const std::string other = differenceOf(own, found.about); !other.empty())
            throw ClusterError(fmt::format("--cluster: the log '{}' is of {}; start this server as the others, or give "
                                           "another --cluster-name",
                                           nameOf(options.engine), other));
        created_ = found.created;
        SavedState state = askedAgain([&] { return load(~0ull); });
        simulation.load(state.simulation); // here it fails before anybody is there
        beginWith(std::move(state));
        first_tick_ = judged_ = agreed_ = log_.tick();
        spdlog::info("joined the log '{}' at tick {} as {}, on {}", nameOf(options.engine), first_tick_, own_.name(),
                     withoutSecrets(options.engine.servers));
    } catch (const EngineAway& error) {
        throw ClusterError(fmt::format("--cluster {}: no answer: {}; does nats-server run with JetStream (-js)?",
                                       withoutSecrets(options.engine.servers), error.what()));
    } catch (const StateError& error) {
        throw ClusterError(fmt::format("--cluster: the snapshot of '{}': {}; --cluster-anew begins a new log when no "
                                       "server runs",
                                       nameOf(options.engine), error.what()));
    }
}

Engine::LogInfo Node::open(const std::string& about) {
    return askedAgain([&] {
        if (options_.anew) engine_.forget();
        return engine_.open(about);
    });
}

// The newest snapshot of a tick up to `last_tick`, or the scene's start where the log has all since then.
SavedState Node::load(uint64_t last_tick) {
    const auto until = Clock::now() + kWhole + std::chrono::seconds(2 * options_.snapshot_s);
    for (;; std::this_thread::sleep_for(kTryAgain)) {
        const auto info = engine_.info();
        if (!info && must_rejoin_) throw EngineAway("the log is not found"); // verify() gives it time
        if (!info) otherLog("it is gone");
        bool changing = false;
        if (auto state = snapshots_.read(*info, last_tick, changing)) return *std::move(state);
        if (!changing && info->first <= 1) return {0, 0, {0, 0, Log().save()}, start_}; // all of it is there
        if (stopping_) throw EngineAway("this server stops");
        if (Clock::now() < until) continue;
        otherLog(changing ? "its snapshot is not whole"
                          : fmt::format("it begins with message {} and has no snapshot from there on", info->first));
    }
}

void Node::beginWith(SavedState state) {
    log_ = Log::load(state.at.log);
    sequence_ = state.at.sequence;
    last_hash_ = state.at.message;
    handover_.begin(std::move(state.simulation), log_.tick());
}

void Node::otherLog(const std::string& why) const {
    throw ClusterError(
        fmt::format("--cluster: the log '{}' cannot be followed: {}; --cluster-anew begins a new one when "
                    "no server runs",
                    nameOf(options_.engine), why));
}

void Node::needRejoin(const std::string& why, uint64_t last_tick) {
    spdlog::warn("loading the shared state anew: {}", why);
    must_rejoin_ = last_tick;
    verified_ = false;
    stand(kRejoins);
}

// Throws EngineAway: it is tried again.
void Node::rejoin(Time now) {
    beginWith(load(*must_rejoin_));
    must_rejoin_.reset();
    own_.rejoined(log_.lastNumber(own_.name()), now);
    votes_.clear();
    judged_ = log_.tick();
    saved_tick_ = 0;
}

// True: the log is the one that was followed, and has all that was followed of it, or a state of it was loaded anew.
// Else this server ends, or tries again.
bool Node::verify(Time now) {
    connections_ = engine_.connections();
    const auto info = engine_.info();
    if (!info) {
        if (!missing_since_) missing_since_ = now;
        if (now - *missing_since_ > kGone) otherLog("it is gone");
        try_at_ = now + kTryAgain;
        return false;
    }
    missing_since_.reset();
    if (info->created != created_) otherLog("another one of that name has taken its place");
    const bool shorter = info->last < sequence_;
    const bool dropped = info->first > sequence_; // by the log's limit: it was there
    const auto message = shorter || dropped || sequence_ == 0 ? std::nullopt : engine_.message(sequence_);
    const bool differs = message && hashOf(*message) != last_hash_;
    if ((shorter || differs) && !must_rejoin_) needRejoin("the log has lost its end");
    known_last_ = info->last;
    if (must_rejoin_) rejoin(now);
    return true;
}

} // namespace brume::cluster
