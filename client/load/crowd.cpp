#include "client/load/crowd.h"

#include <algorithm>
#include <cmath>
#include <future>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "client/load/pusher.h"
#include "client/native/lit_reader.h"
#include "client/native/options.h"
#include "protocol/net/address.h"

namespace brume::load {
namespace {

using client::nowUs;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr uint64_t kPoseEveryUs = 16'393;        // 61 Hz, not 60: no phase to the server's ticks lasts for a whole run
constexpr uint64_t kDrawerPoseEveryUs = 200'000; // viewers who draw by themselves, as pages do
constexpr double kTickUs = 1e6 / 60;
constexpr uint64_t kLookEveryUs = 100'000; // period of the check for viewers that get no frames
constexpr uint64_t kTryEveryUs = 250'000;  // wait of a viewer that found no server, before it tries all again
constexpr size_t kMostNamed = 16;          // servers that goodbyes may name beside those of the options
constexpr uint64_t kFirstFrames = 3;       // one more than are in flight: the first may wait for shaders to be compiled

constexpr char kFirstName[] = "first of a load test";

constexpr float kWider = 1.1f; // factor on the sides of a picture that is to be redrawn

milliseconds millis(double seconds) { return milliseconds(static_cast<int64_t>(seconds * 1e3)); }

} // namespace

struct Crowd::Viewer {
    Viewer(uint32_t with_number, client::Session own, Path along, double begins, size_t watches, const Pusher& pushes)
        : number(with_number), session(std::move(own)), path(along), phase(begins), server(watches), pusher(pushes) {}

    uint32_t number; // from 1
    client::Session session;
    Path path;
    double phase;  // where its path begins, in [0, 1) of a round
    size_t server; // number of the server that it watches
    Pusher pusher;
    client::CameraPath camera;
    uint64_t next_pose_us = 0, heard_us = nowUs(), frames = 0;
    uint64_t lost_us = 0;                // end of its connection; 0 while frames come
    std::optional<uint64_t> next_try_us; // next try to connect; none: the connection has not ended
    size_t tries = 0;                    // connections that have ended since the last frame
    std::string key;                     // Granted::resume of the connection that was lost
    std::deque<uint64_t> unanswered;     // sending times (nowUs()) of poses that no frame has answered yet
    client::LitReader lit;
    float error = 0; // wire::Frame::measured of the last frame; 0: not known
};

Crowd::Crowd(const Options& options, std::vector<client::Endpoint> servers, uint32_t viewers,
             client::Interrupt& interrupt)
    : options_(options), servers_(std::move(servers)), given_(servers_.size()), interrupt_(interrupt),
      start_us_(nowUs()) {
    for (uint32_t i = 0; i < viewers; ++i) {
        const Path path = options.paths[i % options.paths.size()];
        const size_t server = i % given_;
        const double phase = double(i) / viewers;
        Pusher pusher(options.push, options.seed + i, phase);
        viewers_.push_back(std::make_unique<Viewer>(i + 1, session(i + 1, path, server), path, phase, server, pusher));
    }
}

client::Session Crowd::session(uint32_t number, const Path& path, size_t server, const std::string& key) {
    client::Wishes wishes = options_.wishes;
    if (options_.follow) (number == 1 ? wishes.name : wishes.follow) = kFirstName;
    wishes.views = path.stereo ? 2 : 1;
    return {servers_[server], wishes, millis(options_.timeout), loop_, key};
}

Crowd::~Crowd() = default;

ServerRun& Crowd::counts(const Viewer& viewer) {
    for (size_t i = run_->servers.size(); i < servers_.size(); ++i)
        run_->servers.emplace_back().url = servers_[i].url();
    return run_->servers[viewer.server];
}

double Crowd::enter() {
    const uint64_t begin = nowUs();
    const auto ready = [](const auto& viewer) { return viewer->frames >= kFirstFrames; };
    while (double(nowUs() - begin) < options_.warm_up * 1e6 || !std::all_of(viewers_.begin(), viewers_.end(), ready))
        step();
    return double(nowUs() - begin) * 1e-6;
}

void Crowd::during(const std::function<void()>& work) {
    auto done = std::async(std::launch::async, work);
    while (done.wait_for(milliseconds(0)) != std::future_status::ready) step();
    done.get();
}

Run Crowd::watch(double seconds) {
    Run run;
    run.viewers = uint32_t(viewers_.size());
    run.frames.resize(viewers_.size());
    run_ = &run;
    const uint64_t begin = nowUs();
    while (double(nowUs() - begin) < seconds * 1e6) step();
    const uint64_t end = nowUs();
    for (const auto& viewer : viewers_) ++counts(*viewer).viewers;
    run_ = nullptr;
    if (given_ > 1) run.agreement = agreement_;
    run.seconds = double(end - begin) * 1e-6;
    for (const auto& viewer : viewers_)
        if (!viewer->unanswered.empty())
            run.oldest_unanswered_ms =
                std::max(run.oldest_unanswered_ms, double(end - viewer->unanswered.front()) * 1e-3);
    for (const auto& viewer : viewers_)
        if (viewer->error > 0) run.errors_measured.push_back(viewer->error);
    if (const auto frames = double(run.allFrames()); frames > 0)
        for (double StageMeans::*mean : {&StageMeans::wait, &StageMeans::render, &StageMeans::gpu, &StageMeans::encode,
                                         &StageMeans::queue, &StageMeans::decode})
            run.stages.*mean /= frames;
    return run;
}

void Crowd::step() {
    if (interrupt_.asked()) throw std::runtime_error("interrupted");
    uint64_t now = nowUs(), next = now + kLookEveryUs;
    const Viewer *refused = nullptr, *awaited = nullptr; // one that the server refused; one that waits for an answer
    const bool look = now >= next_look_us_;
    if (look) next_look_us_ = now + kLookEveryUs;
    for (const auto& viewer : viewers_) {
        listen(*viewer);
        if (returns(*viewer)) {
            comeBack(*viewer, now);
            next = std::min(next, viewer->next_try_us.value_or(next));
        } else if (viewer->session.welcomed()) {
            if (viewer->session.closed()) fail(*viewer, viewer->session.closedBecause());
            talk(*viewer, now);
            next = std::min({next, viewer->next_pose_us, viewer->pusher.nextUs()});
        } else {
            (viewer->session.closed() ? refused : awaited) = viewer.get();
        }
        if (look && double(now - std::min(now, viewer->heard_us)) > options_.timeout * 1e6)
            fail(*viewer, fmt::format("no frame in {:g} s", options_.timeout));
    }
    if (refused && !awaited) fail(*refused, refused->session.closedBecause());
    now = nowUs();
    if (next > now) loop_.wait(microseconds(next - now));
}

// True: the viewer has no connection, and is to find another. One that never had a frame looks for none, unless it was
// sent on.
bool Crowd::returns(const Viewer& viewer) {
    if (!options_.reconnect || !viewer.session.closed()) return false;
    return viewer.frames > 0 || viewer.lost_us > 0 || named(viewer);
}

void Crowd::comeBack(Viewer& viewer, uint64_t now) {
    if (!viewer.next_try_us) planReturn(viewer, now);
    if (now < *viewer.next_try_us) return;
    viewer.session = session(viewer.number, viewer.path, viewer.server, viewer.key);
    viewer.next_try_us.reset();
}

// Where the viewer tries next, and when: where its server sends it, or at once at the next server. When all that it
// knows have failed, it waits.
void Crowd::planReturn(Viewer& viewer, uint64_t now) {
    if (viewer.session.welcomed()) viewer.key = viewer.session.granted().resume;
    if (viewer.lost_us == 0) {
        viewer.lost_us = now;
        viewer.tries = 0;
        viewer.unanswered.clear();
    }
    const size_t before = viewer.server;
    uint64_t wait_us = 0;
    ++viewer.tries;
    if (const auto to = named(viewer)) {
        viewer.server = *to;
        wait_us = uint64_t(double(viewer.session.retryAfterSeconds()) * 1e6);
    } else {
        if (viewer.server >= given_ || given_ > 1) viewer.server = (viewer.server + 1) % given_;
        if (viewer.tries % given_ == 0) wait_us = kTryEveryUs;
    }
    if (viewer.server != before) viewer.key.clear(); // nobody knows it there
    viewer.next_try_us = now + wait_us;
}

// The number of the server that the goodbye names; nothing for one that may not be loaded, or without TLS after one
// with it.
std::optional<size_t> Crowd::named(const Viewer& viewer) {
    const client::Endpoint& from = servers_[viewer.server];
    auto to = client::parseGoTo(viewer.session.goTo());
    if (!to || (from.tls && !to->tls) || !(options_.anywhere || isLoopback(to->host))) return {};
    for (size_t i = 0; i < servers_.size(); ++i)
        if (servers_[i].url() == to->url()) return i;
    if (servers_.size() >= given_ + kMostNamed) return {};
    to->token = from.token, to->ca = from.ca;
    servers_.push_back(std::move(*to));
    return servers_.size() - 1;
}

bool Crowd::sendPose(client::Session& session, Pose pose) const {
    if (options_.layers == 0) return session.sendPose(pose).has_value();
    pose.fov_y = 2 * std::atan(kWider * std::tan(pose.fov_y / 2));
    const auto wider = [](uint16_t pixels) { return uint16_t(std::lround(kWider * float(pixels))); };
    return session.sendPose(pose, wider(options_.wishes.width), wider(options_.wishes.height), false, options_.layers)
        .has_value();
}

void Crowd::talk(Viewer& viewer, uint64_t now) {
    const double period = client::secondsOf(viewer.path.kind);
    const auto pose = [&] { return viewer.camera.at(double(now - start_us_) * 1e-6 + viewer.phase * period); };
    if (now >= viewer.next_pose_us) {
        Pose next = pose();
        if (viewer.path.stereo) next.eye_separation = client::kEyeSeparation;
        const bool draws = options_.wishes.draw_hz > 0; // no message answers its poses
        if (sendPose(viewer.session, next) && !draws) viewer.unanswered.push_back(now);
        // So often on average, without catching up on a time in which this program did not run.
        const uint64_t every = draws ? kDrawerPoseEveryUs : kPoseEveryUs;
        viewer.next_pose_us = std::max(viewer.next_pose_us + every, now + every / 2);
    }
    if (now < viewer.pusher.nextUs()) return;
    if (const auto push = viewer.pusher.due(now, pose().position, viewer.camera)) {
        viewer.session.sendImpulse(*push);
        if (run_) ++counts(viewer).pushes;
    }
}

void Crowd::listen(Viewer& viewer) {
    while (const auto message = viewer.session.next(milliseconds(0))) {
        if (message->as<wire::Frame>())
            take(viewer, *message);
        else if (message->as<wire::LitParticles>())
            takeLit(viewer, *message);
        else if (const auto* state = message->as<wire::SceneState>())
            agreement_.told(viewer.server, state->tick(), state->state_hash());
        else if (message->as<wire::Welcome>())
            welcome(viewer);
        else if (const auto* error = message->as<wire::Error>())
            refuse(viewer, *error);
    }
}

void Crowd::refuse(const Viewer& viewer, const wire::Error& error) {
    if (!run_) return;
    if (run_->errors++ == 0) run_->first_error = error.text() ? error.text()->str() : "";
    if (error.input_seq() != 0) ++counts(viewer).refused;
}

void Crowd::welcome(Viewer& viewer) {
    const client::Granted& granted = viewer.session.granted();
    if (viewer.number == 1) granted_ = granted;
    viewer.camera = {client::PathKind::orbit, granted.position, granted.target, granted.fov_y};
    if (viewer.path.kind == client::PathKind::still) // each stands at another point of the orbit
        viewer.camera.position = viewer.camera.at(viewer.phase * client::kOrbitSeconds).position;
    viewer.camera.kind = viewer.path.kind;
    viewer.heard_us = nowUs();
    viewer.next_pose_us = viewer.heard_us + uint64_t(viewer.phase * kPoseEveryUs); // spread over the interval
}

void Crowd::take(Viewer& viewer, const client::Received& message) {
    const auto& frame = *message.as<wire::Frame>();
    agreement_.told(viewer.server, frame.tick(), frame.state_hash());
    const uint64_t decode_begin = nowUs();
    if (options_.decode)
        for (uint32_t view = 0; view < frame.jpeg_bytes()->size(); ++view)
            if (!decoder_.decode(message.parsed().view(view), frame.width(), frame.height(), picture_))
                fail(viewer, "a picture is broken: " + decoder_.error());
    const uint64_t shown = nowUs();
    viewer.session.acknowledge(frame.id());
    viewer.error = frame.measured();
    taken(viewer, message, shown);
    // The frame answers all poses up to its own, by the time in it: numbers begin anew with a connection, and the
    // first frames of a viewer that came back show a pose of the connection before.
    while (!viewer.unanswered.empty() && frame.client_time_us() >= viewer.unanswered.front()) {
        if (run_) run_->latencies_ms.push_back(float(shown - viewer.unanswered.front()) * 1e-3f);
        viewer.unanswered.pop_front();
    }
    if (!run_) return;
    run_->ages_ms.push_back(float(shown - std::min(shown, frame.client_time_us())) * 1e-3f);
    const auto& stages = *frame.stages();
    ServerRun& server = counts(viewer);
    ++server.frames;
    server.picture_ms.push_back(stages.render() + stages.encode() + stages.queue());
    StageMeans& sums = run_->stages; // divided at the end
    sums.wait += double(stages.wait());
    sums.render += double(stages.render());
    sums.gpu += double(stages.gpu());
    sums.encode += double(stages.encode());
    sums.queue += double(stages.queue());
    sums.decode += double(shown - decode_begin) * 1e-3;
}

// The medium of a viewer who draws by himself. Its age is the time since its tick, by the clock of the server: the
// message that came with the least delay tells when that was, here.
void Crowd::takeLit(Viewer& viewer, const client::Received& message) {
    const auto& lit = *message.as<wire::LitParticles>();
    agreement_.told(viewer.server, lit.tick(), lit.state_hash());
    const uint64_t begin = nowUs();
    const std::string why = options_.decode ? (viewer.lit.read(lit, message.parsed().jpeg) ? "" : viewer.lit.why())
                                            : client::LitReader::problemOf(lit);
    if (!why.empty()) fail(viewer, why);
    const uint64_t shown = nowUs();
    viewer.session.acknowledge(lit.id());
    viewer.error = lit.measured();
    taken(viewer, message, shown);
    const double from = double(begin) - 1e3 * double(lit.age_ms()) - double(lit.tick()) * kTickUs;
    if (!tick_us_ || from < *tick_us_) tick_us_ = from;
    if (!run_) return;
    run_->ages_ms.push_back(float((double(begin) - *tick_us_ - double(lit.tick()) * kTickUs) * 1e-3));
    ServerRun& server = counts(viewer);
    ++server.frames;
    server.picture_ms.push_back(lit.age_ms());
    run_->stages.decode += double(shown - begin) * 1e-3;
}

void Crowd::taken(Viewer& viewer, const client::Received& message, uint64_t now) {
    viewer.heard_us = now;
    ++viewer.frames;
    if (viewer.lost_us != 0 && run_) run_->returns.push_back({viewer.lost_us, now});
    viewer.lost_us = 0;
    if (!run_) return;
    ++run_->frames[viewer.number - 1];
    run_->bytes += message.size();
}

void Crowd::fail(const Viewer& viewer, const std::string& why) const {
    const auto in =
        std::count_if(viewers_.begin(), viewers_.end(), [](const auto& other) { return other->session.welcomed(); });
    if (size_t(in) < viewers_.size())
        throw std::runtime_error(fmt::format("{} of {} viewers got in: {}", in, viewers_.size(), why));
    throw std::runtime_error(fmt::format("viewer {} of {}: {}", viewer.number, viewers_.size(), why));
}

void Crowd::leave() {
    for (const auto& viewer : viewers_) viewer->session.leave("done");
}

} // namespace brume::load
