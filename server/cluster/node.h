// Node: this server as one of a cluster. A thread of its own follows the log, publishes what viewers ask for, and makes
// ticks go on when that is its turn.
#pragma once

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "server/cluster/engine.h"
#include "server/cluster/handover.h"
#include "server/cluster/log.h"
#include "server/cluster/own_commands.h"
#include "server/cluster/snapshot.h"
#include "server/cluster/ticker.h"
#include "server/cluster/trust.h"
#include "server/cluster/votes.h"
#include "server/loop/tick_source.h"
#include "server/metrics/metrics.h"
#include "server/viewer/audience.h"

namespace brume::cluster {

inline constexpr uint64_t kTellEvery = 60; // ticks between hashes that servers compare

class Node {
public:
    // Joins: connects, opens the log, and loads the newest state. `overrides`: of the scene, as they were given.
    // `audience` outlives this. Throws ClusterError, SceneError.
    Node(const ClusterOptions& options, const Scene& scene, const std::string& scene_text,
         const std::vector<std::string>& overrides, uint64_t memory, Audience& audience);
    // Leaves.
    ~Node();

    uint64_t firstTick() const { return first_tick_; } // of the state that it joined with
    // For the frame loop, which must end before this does.
    std::unique_ptr<TickSource> ticks();
    // To be called by the frame loop after every tick, and after a beginning.
    void ticked(const Simulation& simulation) { handover_.ticked(simulation); }
    // Starts to follow. To be called once, when the frame loop runs.
    void start();
    // From now on other servers send no viewers here.
    void drain();

    // URL of the server with the most room, but for this one; empty: none is known. Thread-safe.
    std::string elsewhere() const;
    // Thread-safe.
    std::vector<Metrics::Sample> samples() const;

private:
    using Time = Clock::time_point;
    void run(const std::stop_token& stop);
    void step(Time now);
    bool verify(Time now);
    void follow();
    void handle(Stored&& message, Time now);
    void give(Log::Step&& step, uint64_t sequence, Time now);
    void waited(Time now);
    void publishCommands(Time now);
    void publishTick(Time now);
    void publishHere();
    void tell();
    void judge(Time now);
    void agrees();
    void differs(const std::string& what, Time now);
    void watch(Time now);
    void stand(const char* why);
    void needRejoin(const std::string& why, uint64_t last_tick = ~0ull);
    void rejoin(Time now);
    template <class Asks>
    auto askedAgain(const Asks& asks) const;
    Engine::LogInfo open(const std::string& about);
    SavedState load(uint64_t last_tick);
    void beginWith(SavedState state);
    void keep(const std::stop_token& stop);
    [[noreturn]] void otherLog(const std::string& why) const;
    void wake();

    static constexpr std::chrono::milliseconds kTryAgain{200}; // what the engine did not answer
    static constexpr const char* kRejoins = "this server loads the shared state anew";

    const ClusterOptions options_;
    const Hosts hosts_{options_.hosts, options_.url};
    Audience& audience_;

    mutable std::mutex mutex_; // guards the next five
    std::condition_variable_any woken_;
    bool awake_ = false;
    std::optional<uint64_t> passed_;  // a tick whose hash is to be told
    std::optional<SavedState> saved_; // to be written
    std::vector<Here> others_;

    Engine engine_; // whose threads use what stands above
    Snapshots snapshots_;
    Handover handover_;
    std::vector<std::byte> start_; // the scene's state before its first tick

    // Of the log's thread.
    Log log_;
    Votes votes_;
    OwnCommands own_;
    Ticker ticker_{Clock::now()};
    int64_t created_ = 0; // Engine::LogInfo::created
    uint64_t first_tick_ = 0;
    uint64_t sequence_ = 0;               // the last message that was handled
    uint64_t last_hash_ = 0;              // hashOf() it; 0: not known
    uint64_t known_last_ = 0;             // sequence that the log had when it was verified
    uint64_t connections_ = 0;            // Engine::connections() when the log was verified last
    bool verified_ = false;               // True: the log is the one that this server has followed
    bool gap_ = false;                    // True: a gap was followed from again
    std::optional<uint64_t> must_rejoin_; // last tick of a state to load; set until that has succeeded
    std::vector<Command> drained_;
    std::vector<Stored> inbox_;
    uint64_t judged_ = 0;     // last tick whose hashes were compared
    uint64_t agreed_ = 0;     // last tick at which this server was as most of them
    uint64_t saved_tick_ = 0; // of the last state that was asked for
    Time heard_at_{}, try_at_{}, stood_at_{}, window_{};
    Time yields_until_{};                  // makes no ticks, so that another server does
    Time again_at_{};                      // a state may be loaded anew
    std::chrono::milliseconds again_{0};   // until then, the next time that this server differs
    std::set<std::string> strange_;        // hosts that viewers are not sent to, and that the log has named
    std::chrono::milliseconds silence_{0}; // without a message, and the log is followed anew
    std::optional<Time> missing_since_;    // the log is not found
    const char* standstill_ = nullptr;
    uint32_t diverged_ = 0;   // times that it differed since it was as the others for long
    uint32_t agreements_ = 0; // comparisons since then at which it was as most of them
    bool aside_ = false;      // True: Handover::standAside()

    std::atomic<bool> draining_{false}, stopping_{false};
    struct {
        std::atomic<bool> ticker{false}, connected{true};
        std::atomic<uint64_t> nodes{0}, divergences{0}, snapshots{0}, snapshot_bytes{0}, takeovers{0}, resent{0},
            log_bytes{0}, commands{0}, lost{0}, stood_ms{0}, wait_ms{0}, wait_before_ms{0}, failed_snapshots{0};
    } counts_;

    std::jthread follower_, keeper_; // last: they use the others
};

} // namespace brume::cluster
