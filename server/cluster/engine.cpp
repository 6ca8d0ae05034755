#include "server/cluster/engine.h"

#include <chrono>
#include <mutex>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "server/cluster/connection.h"

namespace brume::cluster {
namespace {

using std::chrono::milliseconds;

constexpr int32_t kLongestMessage = 256 << 10;
constexpr int64_t kLookMs = 50;            // how often the reader looks whether something else is wanted
constexpr size_t kMostWaiting = 1 << 16;   // messages that nobody has taken
constexpr int64_t kSecond = 1'000'000'000; // ns

} // namespace

struct Engine::State {
    void read(const std::stop_token& stop);
    Subscription subscribe(uint64_t from) const;
    kvStore* values();
    // No two pairs of log and room have the same: the log's length says where the room's name begins.
    std::string stream() const {
        return options.room.empty() ? "brume-" + options.log
                                    : fmt::format("brume_{}_{}_{}", options.log.size(), options.log, options.room);
    }
    std::string subject() const {
        return fmt::format("brume.{}{}{}.log", options.log, options.room.empty() ? "" : ".", options.room);
    }

    EngineOptions options;
    std::function<void()> wake;
    std::unique_ptr<Link> link = std::make_unique<Link>();
    Connection connection;
    Context context;
    std::mutex values_mutex; // guards the next one, and held while it is used
    Values snapshots;        // made when it is first used

    std::mutex mutex; // guards the rest
    std::vector<Stored> inbox;
    std::optional<uint64_t> from; // where to follow from, for the reader
    uint64_t generation = 0;      // of calls of follow()
    std::jthread reader;          // the last member: it uses the others
};

Engine::Engine(const EngineOptions& options, std::function<void()> wake) : state_(std::make_unique<State>()) {
    State& s = *state_;
    s.options = options;
    s.wake = std::move(wake);
    const Options with = optionsOf(options);
    setCallbacks(with.get(), s.link.get());
    natsConnection* connection = nullptr;
    const auto until = std::chrono::steady_clock::now() + options.timeout;
    natsStatus status = natsConnection_Connect(&connection, with.get());
    // It may be about to start, too. What says no is not asked again.
    while ((status == NATS_NO_SERVER || status == NATS_TIMEOUT) && std::chrono::steady_clock::now() < until) {
        std::this_thread::sleep_for(milliseconds(kReconnectMs));
        status = natsConnection_Connect(&connection, with.get());
    }
    if (status != NATS_OK)
        throw ClusterError(fmt::format("--cluster {}: cannot connect: {}; is nats-server running there?",
                                       withoutSecrets(options.servers), textOf(status)));
    s.connection.reset(connection);
    jsOptions js;
    jsOptions_Init(&js);
    js.Wait = std::min(kAnswerMs, options.timeout.count());
    jsCtx* context = nullptr;
    if (status = natsConnection_JetStream(&context, connection, &js); status != NATS_OK)
        throw ClusterError(fmt::format("--cluster: no JetStream: {}", textOf(status)));
    s.context.reset(context);
    s.reader = std::jthread([&s](const std::stop_token& stop) { s.read(stop); });
}

Engine::~Engine() {
    State& s = *state_;
    s.reader.request_stop();
    if (s.reader.joinable()) s.reader.join();
    natsConnection_Close(s.connection.get());
    for (int waits = 0; !s.link->closed && waits < 100; ++waits) std::this_thread::sleep_for(milliseconds(10));
    if (!s.link->closed) static_cast<void>(s.link.release()); // the library may still use it
}

bool Engine::connected() const { return state_->link->connected; }

bool Engine::refused() const { return state_->link->closed; }

uint64_t Engine::connections() const { return state_->link->connections; }

// A log that is just being made has no time yet: NATS tells of it before it is whole.
std::optional<Engine::LogInfo> Engine::info() const {
    const auto until = std::chrono::steady_clock::now() + milliseconds(kAnswerMs);
    for (;;) {
        jsStreamInfo* made = nullptr;
        jsErrCode code = jsErrCode(0);
        const natsStatus status =
            js_GetStreamInfo(&made, state_->context.get(), state_->stream().c_str(), nullptr, &code);
        const Info info(made);
        if (status == NATS_NOT_FOUND || code == JSStreamNotFoundErr) return {};
        if (status != NATS_OK) away("the log", status);
        if (info->Created > 0)
            return LogInfo{info->Created, info->State.FirstSeq, info->State.LastSeq,
                           info->Config->Description ? info->Config->Description : ""};
        if (std::chrono::steady_clock::now() > until) away("the log is being made", NATS_TIMEOUT);
        std::this_thread::sleep_for(milliseconds(1));
    }
}

// Of several servers that make it at a time one does, and the others find it. They may be told that its name exists, or
// that its subjects overlap.
Engine::LogInfo Engine::open(const std::string& about) {
    if (auto found = info()) return *std::move(found);
    const std::string stream = state_->stream(), subject = state_->subject();
    const char* subjects[] = {subject.c_str()};
    jsStreamConfig config;
    jsStreamConfig_Init(&config);
    config.Name = stream.c_str();
    config.Description = about.c_str();
    config.Subjects = subjects;
    config.SubjectsLen = 1;
    config.MaxBytes = int64_t(state_->options.log_bytes); // and no age: clocks do not matter
    config.MaxMsgSize = kLongestMessage;
    config.Replicas = state_->options.replicas;
    config.Duplicates = kSecond; // messages have no ids: what comes twice is seen by Log
    config.DenyDelete = true;
    jsStreamInfo* made = nullptr;
    jsErrCode code = jsErrCode(0);
    const natsStatus status = js_AddStream(&made, state_->context.get(), &config, nullptr, &code);
    const Info info(made);
    const std::string said = textOf(status);
    if (auto found = this->info()) return *std::move(found);
    if (status == NATS_OK || status == NATS_TIMEOUT) away("the log was made and is not there", status);
    throw ClusterError(
        fmt::format("--cluster {}: the log '{}' cannot be made: {}; nats-server needs JetStream (-js), room for "
                    "--cluster-log-size, and as many servers as --cluster-replicas",
                    withoutSecrets(state_->options.servers), nameOf(state_->options), said));
}

void Engine::forget() {
    State& s = *state_;
    for (const std::string& stream : {s.stream(), "KV_" + s.stream()}) {
        jsErrCode code = jsErrCode(0);
        const natsStatus status = js_DeleteStream(s.context.get(), stream.c_str(), nullptr, &code);
        if (status != NATS_OK && status != NATS_NOT_FOUND && code != JSStreamNotFoundErr)
            away("deleting the log", status);
    }
    const std::scoped_lock lock(s.values_mutex);
    s.snapshots.reset();
}

bool Engine::publish(std::string_view text) {
    return natsConnection_Publish(state_->connection.get(), state_->subject().c_str(), text.data(), int(text.size())) ==
           NATS_OK;
}

void Engine::follow(uint64_t from) {
    State& s = *state_;
    const std::scoped_lock lock(s.mutex);
    s.inbox.clear();
    s.from = from;
    ++s.generation;
}

bool Engine::take(std::vector<Stored>& out) {
    State& s = *state_;
    const std::scoped_lock lock(s.mutex);
    if (s.inbox.empty()) return false;
    std::move(s.inbox.begin(), s.inbox.end(), std::back_inserter(out));
    s.inbox.clear();
    return true;
}

// A consumer of its own that acknowledges nothing. A gap in the sequences is noticed by who takes the messages, so
// nothing of it is left to the library.
Subscription Engine::State::subscribe(uint64_t begin) const {
    const std::string name = stream(), of = subject();
    jsSubOptions wanted;
    jsSubOptions_Init(&wanted);
    wanted.Stream = name.c_str();
    wanted.Config.DeliverPolicy = js_DeliverByStartSequence;
    wanted.Config.OptStartSeq = begin;
    wanted.Config.AckPolicy = js_AckNone;
    wanted.Config.MaxDeliver = 1;
    wanted.Config.MemoryStorage = true;
    wanted.Config.Replicas = 1;
    wanted.Config.InactiveThreshold = 5 * kSecond;
    natsSubscription* made = nullptr;
    js_SubscribeSync(&made, context.get(), of.c_str(), nullptr, &wanted, nullptr);
    return Subscription(made);
}

// Follows what is wanted, for as long as the engine lives. A subscription that cannot be made is tried again.
void Engine::State::read(const std::stop_token& stop) {
    Subscription subscription;
    uint64_t followed = 0; // generation of the subscription
    while (!stop.stop_requested()) {
        std::optional<uint64_t> begin;
        {
            const std::scoped_lock lock(mutex);
            if (generation != followed || !subscription) begin = from;
            followed = generation;
        }
        if (begin) {
            subscription.reset();
            subscription = subscribe(*begin);
        }
        if (!subscription) {
            std::this_thread::sleep_for(milliseconds(kLookMs));
            continue;
        }
        natsMsg* next = nullptr;
        const natsStatus status = natsSubscription_NextMsg(&next, subscription.get(), kLookMs);
        const Message message(next);
        if (status == NATS_TIMEOUT) continue;
        jsMsgMetaData* data = nullptr;
        if (status != NATS_OK || natsMsg_GetMetaData(&data, next) != NATS_OK) {
            std::this_thread::sleep_for(milliseconds(kLookMs));
            continue;
        }
        const Owned<jsMsgMetaData, jsMsgMetaData_Destroy> meta(data);
        {
            const std::scoped_lock lock(mutex);
            // What is too much is left out; the gap is noticed, and followed from again.
            if (generation == followed && inbox.size() < kMostWaiting)
                inbox.push_back({meta->Sequence.Stream, {natsMsg_GetData(next), size_t(natsMsg_GetDataLength(next))}});
        }
        wake();
    }
}

std::optional<std::string> Engine::message(uint64_t sequence) const {
    natsMsg* made = nullptr;
    jsErrCode code = jsErrCode(0);
    const natsStatus status =
        js_GetMsg(&made, state_->context.get(), state_->stream().c_str(), sequence, nullptr, &code);
    const Message message(made);
    if (status == NATS_NOT_FOUND) return {};
    if (status != NATS_OK) away("a message of the log", status);
    return std::string(natsMsg_GetData(made), size_t(natsMsg_GetDataLength(made)));
}

kvStore* Engine::State::values() {
    if (snapshots) return snapshots.get();
    const std::string name = stream();
    kvStore* made = nullptr;
    natsStatus status = js_KeyValue(&made, context.get(), name.c_str());
    if (status == NATS_NOT_FOUND) {
        kvConfig config;
        kvConfig_Init(&config);
        config.Bucket = name.c_str();
        config.History = 1;
        config.Replicas = int(options.replicas);
        status = js_CreateKeyValue(&made, context.get(), &config);
    }
    if (status != NATS_OK) away("the snapshots", status);
    snapshots.reset(made);
    return made;
}

void Engine::put(const std::string& key, std::span<const std::byte> bytes) {
    const std::scoped_lock lock(state_->values_mutex);
    if (const natsStatus status = kvStore_Put(nullptr, state_->values(), key.c_str(), bytes.data(), int(bytes.size()));
        status != NATS_OK) {
        state_->snapshots.reset(); // it may be another one when the engine is back
        away("a snapshot", status);
    }
}

std::optional<std::vector<std::byte>> Engine::get(const std::string& key) {
    const std::scoped_lock lock(state_->values_mutex);
    kvEntry* made = nullptr;
    const natsStatus status = kvStore_Get(&made, state_->values(), key.c_str());
    const Entry entry(made);
    if (status == NATS_NOT_FOUND) return {};
    if (status != NATS_OK) {
        state_->snapshots.reset(); // as in put()
        away("a snapshot", status);
    }
    const auto* from = static_cast<const std::byte*>(kvEntry_Value(made));
    return std::vector<std::byte>(from, from + kvEntry_ValueLen(made));
}

} // namespace brume::cluster
