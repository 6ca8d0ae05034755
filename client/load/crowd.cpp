#include "client/load/crowd.h"

#include <algorithm>
#include <future>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "client/native/options.h"

namespace brume::load {
namespace {

using client::nowUs;
using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr uint64_t kPoseEveryUs = 16'393;  // 61 Hz, not 60: no phase to the server's ticks lasts for a whole run
constexpr uint64_t kLookEveryUs = 100'000; // period of the check for viewers that get no frames
constexpr uint64_t kTryEveryUs = 250'000;  // wait before a viewer that lost the server tries to connect again
constexpr uint64_t kFirstFrames = 3;       // one more than are in flight: the first may wait for shaders to be compiled

milliseconds millis(double seconds) { return milliseconds(static_cast<int64_t>(seconds * 1e3)); }

} // namespace

struct Crowd::Viewer {
    uint32_t number; // from 1
    client::Session session;
    Path path;
    double phase; // where its path begins, in [0, 1) of a round
    client::CameraPath camera;
    uint64_t next_pose_us = 0, heard_us = nowUs(), frames = 0;
    uint64_t lost_us = 0, next_try_us = 0; // end of its connection, next try to connect; 0 while frames come
    std::string key;                       // Granted::resume of the connection that was lost
    std::deque<uint64_t> unanswered;       // sending times (nowUs()) of poses that no frame has answered yet
    float error = 0;                       // wire::Frame::measured of the last frame; 0: not known
};

Crowd::Crowd(const Options& options, const client::Endpoint& server, uint32_t viewers, client::Interrupt& interrupt)
    : options_(options), server_(server), interrupt_(interrupt), start_us_(nowUs()) {
    for (uint32_t i = 0; i < viewers; ++i) {
        const Path path = options.paths[i % options.paths.size()];
        viewers_.push_back(std::make_unique<Viewer>(Viewer{i + 1, session(path), path, double(i) / viewers, {}, 0}));
    }
}

client::Session Crowd::session(const Path& path, const std::string& key) {
    client::Wishes wishes = options_.wishes;
    wishes.views = path.stereo ? 2 : 1;
    return {server_, wishes, millis(options_.timeout), loop_, key};
}

Crowd::~Crowd() = default;

const client::Granted& Crowd::granted() const { return viewers_.front()->session.granted(); }

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
    run_ = nullptr;
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
        if (options_.reconnect && viewer->frames > 0 && viewer->session.closed()) {
            comeBack(*viewer, now);
            next = std::min(next, viewer->next_try_us);
        } else if (viewer->session.welcomed()) {
            if (viewer->session.closed()) fail(*viewer, viewer->session.closedBecause());
            talk(*viewer, now);
            next = std::min(next, viewer->next_pose_us);
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

void Crowd::comeBack(Viewer& viewer, uint64_t now) {
    if (viewer.session.welcomed()) viewer.key = viewer.session.granted().resume;
    if (viewer.lost_us == 0) {
        viewer.lost_us = now;
        viewer.unanswered.clear();
    } else if (now >= viewer.next_try_us) {
        viewer.session = session(viewer.path, viewer.key);
    } else {
        return;
    }
    viewer.next_try_us = now + kTryEveryUs;
}

void Crowd::talk(Viewer& viewer, uint64_t now) const {
    if (now < viewer.next_pose_us) return;
    const double period = viewer.path.kind == client::PathKind::fly ? client::kFlySeconds : client::kOrbitSeconds;
    Pose pose = viewer.camera.at(double(now - start_us_) * 1e-6 + viewer.phase * period);
    if (viewer.path.stereo) pose.eye_separation = client::kEyeSeparation;
    if (viewer.session.sendPose(pose)) viewer.unanswered.push_back(now);
    // 61 a second on average, without catching up on a time in which this program did not run.
    viewer.next_pose_us = std::max(viewer.next_pose_us + kPoseEveryUs, now + kPoseEveryUs / 2);
}

void Crowd::listen(Viewer& viewer) {
    while (const auto message = viewer.session.next(milliseconds(0))) {
        if (message->as<wire::Frame>()) {
            take(viewer, *message);
        } else if (message->as<wire::Welcome>()) {
            welcome(viewer);
        } else if (const auto* error = message->as<wire::Error>(); error && run_) {
            if (run_->errors++ == 0) run_->first_error = error->text() ? error->text()->str() : "";
        }
    }
}

void Crowd::welcome(Viewer& viewer) {
    const client::Granted& granted = viewer.session.granted();
    viewer.camera = {client::PathKind::orbit, granted.position, granted.target, granted.fov_y};
    if (viewer.path.kind == client::PathKind::still) // each stands at another point of the orbit
        viewer.camera.position = viewer.camera.at(viewer.phase * client::kOrbitSeconds).position;
    viewer.camera.kind = viewer.path.kind;
    viewer.heard_us = nowUs();
    viewer.next_pose_us = viewer.heard_us + uint64_t(viewer.phase * kPoseEveryUs); // spread over the interval
}

void Crowd::take(Viewer& viewer, const client::Received& message) {
    const auto& frame = *message.as<wire::Frame>();
    const uint64_t decode_begin = nowUs();
    if (options_.decode)
        for (uint32_t view = 0; view < frame.jpeg_bytes()->size(); ++view)
            if (!decoder_.decode(message.parsed().view(view), frame.width(), frame.height(), picture_))
                fail(viewer, "a picture is broken: " + decoder_.error());
    const uint64_t shown = nowUs();
    viewer.session.acknowledge(frame.id());
    viewer.heard_us = shown;
    ++viewer.frames;
    viewer.error = frame.measured();
    if (viewer.lost_us != 0 && run_) run_->returns.push_back({viewer.lost_us, shown});
    viewer.lost_us = 0;
    // The frame answers all poses up to its own, by the time in it: numbers begin anew with a connection, and the
    // first frames of a viewer that came back show a pose of the connection before.
    while (!viewer.unanswered.empty() && frame.client_time_us() >= viewer.unanswered.front()) {
        if (run_) run_->latencies_ms.push_back(float(shown - viewer.unanswered.front()) * 1e-3f);
        viewer.unanswered.pop_front();
    }
    if (!run_) return;
    ++run_->frames[viewer.number - 1];
    run_->ages_ms.push_back(float(shown - std::min(shown, frame.client_time_us())) * 1e-3f);
    run_->bytes += message.size();
    const auto& stages = *frame.stages();
    StageMeans& sums = run_->stages; // divided at the end
    sums.wait += double(stages.wait());
    sums.render += double(stages.render());
    sums.gpu += double(stages.gpu());
    sums.encode += double(stages.encode());
    sums.queue += double(stages.queue());
    sums.decode += double(shown - decode_begin) * 1e-3;
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
