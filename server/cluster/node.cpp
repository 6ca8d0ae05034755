#include "server/cluster/node.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "common/text.h"
#include "server/cluster/ticks.h"

namespace brume::cluster {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kStandstill{300};   // without ticks, and viewers are told
constexpr milliseconds kSilence{1000};     // without any message, and the log is followed anew
constexpr milliseconds kLongSilence{8000}; // for which it waits when that did not help
constexpr milliseconds kWindow{10'000};    // of the longest wait
constexpr uint64_t kMostBehind = 3600;     // ticks that wait for the frame loop; with so many, messages wait
constexpr uint32_t kTrusted = 10;          // comparisons in a row, a second each, and a server is one of the others
constexpr milliseconds kYield{1000};       // without a tick of a server that stands aside: another one begins
constexpr milliseconds kFirstAgain{10'000}, kLastAgain{300'000}; // between two states that it loads
constexpr size_t kMostStrange = 16;                              // hosts that a line is written of

constexpr const char* kNoEngine = "the log that the servers share cannot be reached; cameras go on, ticks wait for it";
constexpr const char* kNoTicks = "no server makes ticks at present; cameras go on";

} // namespace

Node::~Node() {
    stopping_ = true;
    audience_.commands().serve(nullptr);
}

std::unique_ptr<TickSource> Node::ticks() { return std::make_unique<ClusterTicks>(handover_); }

void Node::start() {
    audience_.commands().serve([this] { wake(); });
    follower_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
    keeper_ = std::jthread([this](const std::stop_token& stop) { keep(stop); });
}

void Node::wake() {
    const std::scoped_lock lock(mutex_);
    awake_ = true;
    woken_.notify_all();
}

void Node::drain() {
    draining_ = true;
    {
        const std::scoped_lock lock(mutex_);
        passed_ = handover_.present().first;
    }
    wake();
}

void Node::run(const std::stop_token& stop) {
    ticker_ = Ticker(Clock::now());
    heard_at_ = Clock::now();
    silence_ = kSilence;
    try {
        while (!stop.stop_requested()) {
            {
                std::unique_lock lock(mutex_);
                const Time latest = Clock::now() + kTick;
                const bool makes_ticks = counts_.ticker && counts_.connected && verified_;
                woken_.wait_until(lock, stop, makes_ticks ? std::min(ticker_.next(), latest) : latest,
                                  [&] { return awake_; });
                awake_ = false;
            }
            try {
                step(Clock::now());
            } catch (const EngineAway& error) {
                spdlog::debug("the log: {}", error.what());
                verified_ = false;
                missing_since_.reset();
                try_at_ = Clock::now() + kTryAgain;
            }
        }
    } catch (const std::exception&) {
        handover_.fail(std::current_exception());
    }
}

void Node::step(Time now) {
    if (engine_.refused())
        throw ClusterError(
            "--cluster: NATS does not let this server in any more: look at its log, and at the password or "
            "--cluster-credentials");
    const bool connected = engine_.connected();
    counts_.connected = connected;
    watch(now);
    if (connected && engine_.connections() != connections_) verified_ = false;
    if (connected && !verified_ && now >= try_at_ && verify(now)) follow();
    if (!verified_) return;
    if (handover_.behind() > kMostBehind) {
        heard_at_ = now;
        ticker_.ticked(now); // ticks come, though none of them is new
    } else {
        engine_.take(inbox_);
    }
    for (Stored& message : inbox_) {
        if (!verified_) break; // what is left comes again
        handle(std::move(message), now);
    }
    inbox_.clear();
    if (!connected || !verified_) return;
    if (sequence_ >= known_last_) publishCommands(now); // not before it has read what it may have published
    publishTick(now);
    publishHere();
    judge(now);
}

void Node::follow() {
    engine_.follow(sequence_ + 1);
    verified_ = true;
    heard_at_ = Clock::now();
}

void Node::handle(Stored&& message, Time now) {
    // One that was there: the log has lost its end and goes on from before.
    if (message.sequence <= sequence_) return void(verified_ = false);
    if (message.sequence != sequence_ + 1) { // it was too much for the connection, or is not there any more
        verified_ = false;
        if (std::exchange(gap_, !gap_))
            needRejoin(fmt::format("messages {} to {} are missing", sequence_ + 1, message.sequence - 1));
        return;
    }
    gap_ = false;
    heard_at_ = now;
    silence_ = kSilence;
    sequence_ = message.sequence;
    counts_.log_bytes += message.text.size();
    last_hash_ = hashOf(message.text);
    auto read = unpack(message.text);
    if (!read) return spdlog::warn("message {} of the log is none of ours and is ignored", sequence_);
    const auto* const here = std::get_if<Here>(&*read);
    if (here) votes_.note(here->tick, here->node, here->hash);
    const auto* const command = std::get_if<NodeCommand>(&*read);
    const uint64_t own_number = command && command->node == own_.name() ? command->number : 0;
    const bool is_here = here != nullptr;
    if (auto step = log_.take(*std::move(read))) give(*std::move(step), sequence_, now);
    if (own_number > 0) own_.came(own_number, log_.lastNumber(own_.name()), now);
    if (is_here) tell();
}

void Node::give(Log::Step&& step, uint64_t sequence, Time now) {
    std::vector<Command> commands;
    counts_.commands += step.commands.size();
    for (NodeCommand& command : step.commands) commands.push_back(own_.take(std::move(command)));
    const bool was = counts_.ticker, is = log_.ticker() == own_.name();
    counts_.ticker = is;
    if (is && !was) {
        ++counts_.takeovers;
        spdlog::info("this server makes the ticks from tick {} on", step.first);
    }
    std::optional<LogPoint> save;
    const uint64_t every = uint64_t(options_.snapshot_s) * 60;
    if (is && !aside_ && (saved_tick_ == 0 || step.last >= saved_tick_ + every)) {
        saved_tick_ = step.last;
        save = {sequence, last_hash_, log_.save()};
    }
    handover_.give(step.last, std::move(commands), std::move(save));
    waited(now);
    ticker_.ticked(now);
    if (standstill_) stand(nullptr);
}

// For the longest wait of the last ten to twenty seconds.
void Node::waited(Time now) {
    const auto ms = uint64_t(std::chrono::duration_cast<milliseconds>(now - ticker_.lastTick()).count());
    if (now - window_ > kWindow) {
        counts_.wait_before_ms = counts_.wait_ms.exchange(0);
        window_ = now;
    }
    counts_.wait_ms = std::max<uint64_t>(counts_.wait_ms, ms);
}

void Node::publishCommands(Time now) {
    for (const std::string& message : own_.overdue(now)) engine_.publish(message);
    counts_.resent = own_.resent();
    counts_.lost = own_.lost();
    if (!own_.hasRoom()) return;
    audience_.commands().drain(drained_);
    for (Command& command : drained_) engine_.publish(own_.add(std::move(command), now));
    drained_.clear();
}

void Node::publishTick(Time now) {
    if (now < yields_until_) return;
    const std::string& name = own_.name();
    const auto tick = ticker_.due(now, {log_.ticker() == name, log_.rank(name), log_.tick(), handover_.behind()});
    if (tick) engine_.publish(pack(Advance{name, *tick}));
}

void Node::publishHere() {
    std::optional<uint64_t> tick;
    {
        const std::scoped_lock lock(mutex_);
        tick = std::exchange(passed_, std::nullopt);
    }
    if (!tick) return;
    const auto hash = handover_.hashOf(*tick);
    if (!hash) return;
    const double load =
        std::max(double(audience_.budget_used), audience_.withPictures() / std::max(1.0, double(audience_.places())));
    const bool takes = audience_.ready && !draining_ && load < 1;
    engine_.publish(pack(Here{own_.name(), *tick, *hash, options_.url, load, takes}));
}

// What is known of the other servers, for those who ask elsewhere(). A URL in the log is a word of whoever wrote it.
void Node::tell() {
    std::vector<Here> others = log_.present();
    counts_.nodes = others.size();
    std::erase_if(others, [&](const Here& one) { return one.node == own_.name() || one.url == options_.url; });
    for (Here& one : others) {
        if (one.url.empty() || hosts_.allow(one.url)) continue;
        const std::string host = oneLine(hostOf(one.url));
        if (strange_.size() < kMostStrange && strange_.insert(host).second)
            spdlog::warn("server {} wants viewers at {}, and none are sent there: --cluster-hosts does not name it",
                         oneLine(one.node), host);
        one.url.clear();
    }
    const std::scoped_lock lock(mutex_);
    others_ = std::move(others);
}

// A second after each tick that is compared: by then all servers have said theirs.
void Node::judge(Time now) {
    const uint64_t present = handover_.present().first, due = present / kTellEvery * kTellEvery;
    if (due < judged_ + 2 * kTellEvery) return;
    judged_ = due - kTellEvery;
    const auto own = handover_.hashOf(judged_), right = votes_.winner(judged_, log_.ticker());
    if (!own || !right) return;
    if (*own == *right) return agrees();
    ++counts_.divergences;
    differs(fmt::format("at tick {} its state was {:016x}, that of most servers {:016x}", judged_, *own, *right), now);
}

void Node::agrees() {
    agreed_ = judged_;
    if (diverged_ == 0 || ++agreements_ < kTrusted) return;
    diverged_ = 0;
    if (!std::exchange(aside_, false)) return;
    handover_.standAside(false);
    spdlog::info("this server is as the others again, and takes viewers");
}

// The first time it goes on from a state that was right. From the second time on it stands aside, and tries that more
// and more seldom: it cannot know whether it computes wrong or others lie.
void Node::differs(const std::string& what, Time now) {
    agreements_ = 0;
    if (now < again_at_) return;
    if (++diverged_ == 1) {
        again_ = kFirstAgain;
        spdlog::error("this server differs from the others: {}", what);
        return needRejoin("it differs from the others", agreed_);
    }
    again_at_ = now + again_;
    again_ = std::min(2 * again_, kLastAgain);
    spdlog::error("this server differs from the others again, and stands aside: {}; its memory, compiler or processor "
                  "computes differently, or somebody else writes to the log",
                  what);
    if (!std::exchange(aside_, true)) {
        handover_.standAside(true);
        yields_until_ = now + kYield;
    }
    needRejoin("it differs from the others");
}

// What viewers are told while no tick comes, and that the log is followed anew when it is silent.
void Node::watch(Time now) {
    if (now - ticker_.lastTick() > kStandstill && standstill_ != kRejoins)
        stand(verified_ && counts_.connected ? kNoTicks : kNoEngine);
    if (verified_ && now - heard_at_ > silence_) {
        verified_ = false;
        silence_ = std::min(2 * silence_, kLongSilence);
    }
    if (standstill_) {
        counts_.stood_ms += uint64_t(std::chrono::duration_cast<milliseconds>(now - stood_at_).count());
        stood_at_ += std::chrono::duration_cast<milliseconds>(now - stood_at_);
    }
}

// Null: ticks come. While they do not, commands are answered: busy.
void Node::stand(const char* why) {
    if (why == standstill_) return;
    if (!standstill_) stood_at_ = ticker_.lastTick();
    if (why)
        spdlog::warn("no ticks: {}", why);
    else
        spdlog::info("ticks go on");
    standstill_ = why;
    audience_.commands().close(why);
    handover_.stand(why);
}

// Writes snapshots, apart from what must be in time.
void Node::keep(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        std::optional<SavedState> state;
        {
            std::unique_lock lock(mutex_);
            if (!woken_.wait(lock, stop, [&] { return saved_.has_value(); })) return;
            state = std::exchange(saved_, std::nullopt);
        }
        try {
            counts_.snapshot_bytes = snapshots_.write(*state, created_);
            ++counts_.snapshots;
        } catch (const std::exception& error) { // of the engine, or no memory
            ++counts_.failed_snapshots;
            spdlog::warn("no snapshot of tick {}: {}", state->tick, error.what());
        }
    }
}

std::string Node::elsewhere() const {
    const std::scoped_lock lock(mutex_);
    const Here* best = nullptr;
    for (const Here& one : others_)
        if (one.takes && !one.url.empty() && (!best || one.load < best->load)) best = &one;
    return best ? best->url : "";
}

std::vector<Metrics::Sample> Node::samples() const {
    const auto& c = counts_;
    return {
        {"brume_cluster_ticker", "1 while this server makes the ticks.", false, double(c.ticker)},
        {"brume_cluster_connected", "1 while the log can be reached.", false, double(c.connected)},
        {"brume_cluster_nodes", "Servers that said they were there within five seconds.", false, double(c.nodes)},
        {"brume_cluster_tick", "The last tick that is simulated.", false, double(handover_.present().first)},
        {"brume_cluster_lag_ticks", "Ticks of the log that are not simulated yet.", false, double(handover_.behind())},
        {"brume_cluster_divergences_total", "Times that this server differed from the others.", true,
         double(c.divergences)},
        {"brume_cluster_snapshots_total", "Snapshots that this server wrote.", true, double(c.snapshots)},
        {"brume_cluster_snapshots_failed_total", "Snapshots that could not be written.", true,
         double(c.failed_snapshots)},
        {"brume_cluster_snapshot_bytes", "Size of the last one.", false, double(c.snapshot_bytes)},
        {"brume_cluster_takeovers_total", "Times that this server began to make the ticks.", true, double(c.takeovers)},
        {"brume_cluster_commands_total", "Commands of the log, of all servers.", true, double(c.commands)},
        {"brume_cluster_resent_total", "Commands that were sent again.", true, double(c.resent)},
        {"brume_cluster_lost_total", "Commands that went with the end of the log.", true, double(c.lost)},
        {"brume_cluster_log_bytes_total", "Bytes of the log's messages that were read.", true, double(c.log_bytes)},
        {"brume_cluster_longest_wait_seconds", "Longest time between two ticks of the last ten to twenty seconds.",
         false, double(std::max<uint64_t>(c.wait_ms, c.wait_before_ms)) * 1e-3},
        {"brume_cluster_standstill_seconds_total", "Time without ticks.", true, double(c.stood_ms) * 1e-3},
    };
}

} // namespace brume::cluster
