#include "client/native/headless.h"

#include <algorithm>
#include <iostream>
#include <stdexcept>

#include <fmt/format.h>

#include "client/native/jpeg.h"

namespace brume::client {
namespace {

using std::chrono::milliseconds;

constexpr uint64_t kPoseEveryUs = 16'667; // as a display of 60 Hz would
constexpr uint64_t kPingEveryUs = 1'000'000;

class Watch {
public:
    Watch(const Options& options, Interrupt& interrupt)
        : options_(options), interrupt_(interrupt), recorder_(options.out, options.save), statistics_(options.endpoint.url()),
          session_(options.endpoint, options.wishes, milliseconds(static_cast<int64_t>(options.timeout * 1000))) {}

    void run() {
        const std::string failure = watch();
        statistics_.roundTrip(session_.roundTripMs());
        statistics_.ended(failure.empty() ? "as asked" : failure);
        session_.leave("done");
        if (statistics_.frames() > 0) std::cout << statistics_.summary() << std::endl;
        recorder_.statistics(statistics_);
        if (!failure.empty()) throw std::runtime_error(failure);
    }

private:
    // Returns what went wrong; empty when it ended as the user asked.
    std::string watch() {
        uint64_t heard_us = nowUs(); // the newest frame, or the start
        while (!interrupt_.asked() && !done()) {
            const uint64_t now = nowUs();
            if (static_cast<double>(now - heard_us) > options_.timeout * 1e6) return noFrame();
            if (welcomed_) talk(now);
            const auto message = session_.next(milliseconds(welcomed_ ? 5 : 50));
            if (!message) {
                if (session_.closed()) return closed();
                continue;
            }
            if (message->as<wire::Frame>()) {
                heard_us = message->receivedUs();
                if (!take(*message)) return "a picture from the server is broken: " + decoder_.error();
            } else if (message->as<wire::Welcome>()) {
                start();
            } else if (const auto* error = message->as<wire::Error>()) {
                statistics_.error(*error);
            }
        }
        return "";
    }

    bool done() const {
        if (options_.frames > 0 && statistics_.frames() >= options_.frames) return true;
        return options_.seconds > 0 && first_us_ > 0 && static_cast<double>(nowUs() - first_us_) >= options_.seconds * 1e6;
    }

    void start() {
        welcomed_ = true;
        statistics_.welcome(session_.granted());
        const Granted& granted = session_.granted();
        camera_ = options_.camera.value_or(CameraPath{options_.path, granted.position, granted.target, granted.fov_y});
        camera_.fov_y = granted.fov_y;
        start_us_ = nowUs();
    }

    // Poses, pushes and pings that are due.
    void talk(uint64_t now) {
        if (now >= next_pose_us_) {
            Pose pose = camera_.at(static_cast<double>(now - start_us_) * 1e-6);
            if (options_.wishes.views == 2) pose.eye_separation = kEyeSeparation;
            session_.sendPose(pose);
            next_pose_us_ = now + kPoseEveryUs;
        }
        if (now >= next_ping_us_) {
            session_.sendPing();
            next_ping_us_ = now + kPingEveryUs;
        }
        while (first_us_ > 0 && pushed_ < options_.pushes.size() &&
               static_cast<double>(now - first_us_) >= options_.pushes[pushed_].seconds * 1e6) {
            session_.sendPush(options_.pushes[pushed_++].push);
            statistics_.inputSent();
        }
    }

    // Decodes (to know that the picture is whole), records, acknowledges. False when the picture is broken.
    bool take(const Received& message) {
        const auto& frame = *message.as<wire::Frame>();
        const uint64_t decode_start = nowUs();
        for (uint32_t view = 0; view < frame.jpeg_bytes()->size(); ++view)
            if (!decoder_.decode(message.parsed().view(view), frame.width(), frame.height(), picture_)) return false;
        const uint64_t presented = nowUs();
        session_.acknowledge(frame.id());
        if (first_us_ == 0) first_us_ = presented;
        statistics_.frame(recordOf(message, static_cast<float>(presented - decode_start) * 1e-3f, presented));
        recorder_.frame(message);
        return true;
    }

    std::string noFrame() const {
        return fmt::format("no frame from {} in {:g} s{}", options_.endpoint.url(), options_.timeout,
                           statistics_.lastError().empty() ? "" : "; the server said: " + statistics_.lastError());
    }

    std::string closed() const {
        std::string why = session_.closedBecause();
        if (session_.retryAfterSeconds() > 0) why += fmt::format(" (try again in {:g} s)", session_.retryAfterSeconds());
        if (statistics_.frames() > 0) why += fmt::format(" (after {} frames)", statistics_.frames());
        return why;
    }

    const Options& options_;
    Interrupt& interrupt_;
    Recorder recorder_; // first, so that a folder that cannot be written is told before anything is connected
    Statistics statistics_;
    Session session_;
    JpegDecoder decoder_;
    Picture picture_;
    CameraPath camera_;
    bool welcomed_ = false;
    uint64_t start_us_ = 0, first_us_ = 0; // welcome, first frame
    uint64_t next_pose_us_ = 0, next_ping_us_ = 0;
    size_t pushed_ = 0;
};

} // namespace

void runHeadless(const Options& options, Interrupt& interrupt) { Watch(options, interrupt).run(); }

} // namespace brume::client
