#include "client/native/headless.h"

#include <algorithm>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "client/native/jpeg.h"
#include "client/native/link.h"
#include "client/native/lit_reader.h"

namespace brume::client {
namespace {

using std::chrono::milliseconds;

constexpr uint64_t kPoseEveryUs = 16'667; // as a display of 60 Hz would
constexpr uint64_t kPingEveryUs = 1'000'000;
constexpr milliseconds kBetweenTries{20}; // the most that Ctrl-C waits

class Watch {
public:
    Watch(const Options& options, Interrupt& interrupt, Painter* painter)
        : options_(options), interrupt_(interrupt), painter_(painter), recorder_(options.out, options.save),
          statistics_(options.servers.front().url()), link_(options, false) {}

    void run() {
        std::string failure;
        try {
            watch();
        } catch (const std::exception& error) {
            failure = error.what();
            if (statistics_.frames() > 0) failure += fmt::format(" (after {} frames)", statistics_.frames());
        }
        statistics_.ended(failure.empty() ? "as asked" : failure);
        link_.leave("done");
        if (statistics_.frames() > 0) std::cout << statistics_.summary() << std::endl;
        recorder_.statistics(statistics_);
        if (!failure.empty()) throw std::runtime_error(failure);
    }

private:
    void watch() {
        while (!interrupt_.asked() && !done()) {
            Session* const session = link_.session(options_.wishes);
            if (!session) {
                std::this_thread::sleep_for(kBetweenTries);
                continue;
            }
            if (session->welcomed()) talk(*session, nowUs());
            const auto message = session->next(milliseconds(session->welcomed() ? 5 : 50));
            if (!message)
                link_.check(statistics_.lastError());
            else if (message->as<wire::Frame>())
                take(*session, *message);
            else if (message->as<wire::LitParticles>())
                paint(*session, *message);
            else if (message->as<wire::Welcome>())
                welcome(session->granted());
            else if (const auto* state = message->as<wire::SceneState>())
                look(*session, state->paused());
            else if (const auto* error = message->as<wire::Error>())
                statistics_.error(*error);
        }
    }

    // Says once when the scene comes to a standstill. A camera that rests gets no frames then, nor of a paused scene,
    // and misses none.
    void look(const Session& session, bool paused) {
        const std::string& why = session.standstill();
        if (paused || !why.empty()) link_.heard(nowUs());
        if (!why.empty() && !standing_) std::cerr << "brume-client: the scene stands still: " << why << std::endl;
        standing_ = !why.empty();
    }

    bool done() const {
        if (options_.frames > 0 && statistics_.frames() >= options_.frames) return true;
        return options_.seconds > 0 && first_us_ > 0 &&
               static_cast<double>(nowUs() - first_us_) >= options_.seconds * 1e6;
    }

    void welcome(const Granted& granted) {
        statistics_.welcome(granted);
        next_ping_us_ = 0;
        awaited_pose_.reset();
        // A welcome to the same scene, after a lost connection: the camera goes on.
        if (granted.scene == std::exchange(scene_, granted.scene) && start_us_ > 0) return;
        camera_ = options_.camera.value_or(CameraPath{options_.path, granted.position, granted.target, granted.fov_y});
        camera_.fov_y = granted.fov_y;
        camera_.keys = options_.keys;
        if (!camera_.keys && !granted.keys.empty()) camera_.keys = std::make_shared<const KeyPath>(granted.keys);
        start_us_ = nowUs();
    }

    // True: the camera goes from frame to frame in even steps of one round, not with the clock.
    bool stepwise() const { return options_.pause && options_.frames > 0 && options_.path == PathKind::orbit; }

    double pathSeconds(uint64_t now) const {
        if (!stepwise()) return static_cast<double>(now - start_us_) * 1e-6;
        return kOrbitSeconds * static_cast<double>(statistics_.frames()) / static_cast<double>(options_.frames);
    }

    // Poses, pushes and pings that are due.
    void talk(Session& session, uint64_t now) {
        if (options_.pause && !std::exchange(paused_, true)) session.sendPaused(true);
        if (now >= next_pose_us_) {
            Pose pose = camera_.at(pathSeconds(now));
            if (options_.wishes.views == 2) pose.eye_separation = kEyeSeparation;
            const std::optional<uint32_t> sent = session.sendPose(pose);
            if (!awaited_pose_) awaited_pose_ = sent;
            next_pose_us_ = now + kPoseEveryUs;
        }
        if (now >= next_ping_us_) {
            session.sendPing();
            next_ping_us_ = now + kPingEveryUs;
        }
        while (first_us_ > 0 && impulses_sent_ < options_.impulses.size() &&
               static_cast<double>(now - first_us_) >= options_.impulses[impulses_sent_].seconds * 1e6) {
            session.sendImpulse(options_.impulses[impulses_sent_++].impulse);
            statistics_.inputSent();
        }
    }

    // Decodes (to know that the picture is whole), records, acknowledges.
    void take(Session& session, const Received& message) {
        const auto& frame = *message.as<wire::Frame>();
        const uint64_t decode_start = nowUs();
        for (uint32_t view = 0; view < frame.jpeg_bytes()->size(); ++view)
            if (!decoder_.decode(message.parsed().view(view), frame.width(), frame.height(), picture_))
                throw std::runtime_error("a picture from the server is broken: " + decoder_.error());
        const uint64_t presented = nowUs();
        session.acknowledge(frame.id());
        link_.heard(presented);
        if (stepwise()) {
            if (!awaited_pose_ || frame.pose_seq() < *awaited_pose_) return statistics_.dropped();
            awaited_pose_.reset();
            next_pose_us_ = 0;
        }
        statistics_.roundTrip(session.roundTripMs());
        if (first_us_ == 0) first_us_ = presented;
        statistics_.frame(recordOf(message, static_cast<float>(presented - decode_start) * 1e-3f, presented));
        recorder_.frame(message);
    }

    // Draws what the server has lit, as the camera sees it now.
    void paint(Session& session, const Received& message) {
        const auto& lit = *message.as<wire::LitParticles>();
        const lit::Rows* const rows = reader_.read(lit, message.parsed().jpeg);
        if (!rows) throw std::runtime_error("the server sent " + reader_.why());
        const uint64_t begin = nowUs();
        const Pose pose = camera_.at(pathSeconds(begin));
        painter_->take(lit, *rows);
        painter_->draw(pose, options_.wishes.width, options_.wishes.height, picture_);
        const uint64_t presented = nowUs();
        session.acknowledge(lit.id());
        link_.heard(presented);
        statistics_.roundTrip(session.roundTripMs());
        if (first_us_ == 0) first_us_ = presented;
        statistics_.frame(recordOf(message, static_cast<float>(presented - begin) * 1e-3f, presented, pose, picture_));
        recorder_.picture(picture_);
    }

    const Options& options_;
    Interrupt& interrupt_;
    Painter* const painter_; // null: pictures come from the server
    LitReader reader_;
    Recorder recorder_; // first, so that a folder that cannot be written is told before anything is connected
    Statistics statistics_;
    Link link_;
    JpegDecoder decoder_;
    Picture picture_;
    CameraPath camera_;
    std::string scene_;
    uint64_t start_us_ = 0, first_us_ = 0; // welcome to the present scene, first frame
    bool paused_ = false;                  // true: Options::pause was carried out
    bool standing_ = false;                // true: the server says that the scene stands still
    uint64_t next_pose_us_ = 0, next_ping_us_ = 0;
    std::optional<uint32_t> awaited_pose_; // number of the first pose at the present step; none: not sent yet
    size_t impulses_sent_ = 0;
};

} // namespace

void runHeadless(const Options& options, Interrupt& interrupt, Painter* painter) {
    Watch(options, interrupt, painter).run();
}

} // namespace brume::client
