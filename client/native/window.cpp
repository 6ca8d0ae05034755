#include "client/native/window.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <utility>

#include <SDL2/SDL.h>
#include <fmt/format.h>

#include "client/native/display.h"
#include "client/native/gestures.h"
#include "client/native/jpeg.h"
#include "client/native/link.h"
#include "client/native/lit_reader.h"
#include "client/native/people_keys.h"
#include "client/native/recorder.h"

namespace brume::client {
namespace {

using std::chrono::milliseconds;

constexpr uint64_t kPoseEveryUs = 16'667; // 60 Hz, sent while nothing moves too: each measures the latency anew
constexpr uint64_t kRedrawEveryUs = 16'667;
constexpr uint64_t kPushEveryUs = 33'333; // a drag is many events
constexpr uint64_t kSayEveryUs = 50'000;  // so often the server tells others of it
constexpr uint64_t kSecondUs = 1'000'000;
constexpr uint64_t kTitleEveryUs = 500'000;
constexpr uint64_t kToldUs = 4'000'000;      // what the server refused stays in the title
constexpr uint64_t kResizeAfterUs = 150'000; // a size is asked for when the hand rests
// The socket is waited for, the window is asked in between: the most that a key stroke waits.
constexpr milliseconds kLoopWait{4};
constexpr float kWider = 1.1f; // factor on the sides of a picture that is redrawn

class WindowedViewer {
public:
    WindowedViewer(const Options& options, Interrupt& interrupt, Painter* painter)
        : options_(options), interrupt_(interrupt), painter_(painter), recorder_(options.out, options.save),
          statistics_(options.servers.front().url()),
          display_("brume: connecting to " + options.servers.front().url(), options.wishes.width * options.wishes.views,
                   options.wishes.height),
          wishes_(options.wishes), link_(options, true), people_keys_(options.wishes.views) {}

    void run() {
        std::string failure;
        try {
            watch();
        } catch (const std::exception& error) {
            failure = error.what();
        }
        statistics_.ended(failure.empty() ? "as asked" : failure);
        link_.leave("the window was closed");
        if (statistics_.frames() > 0) std::cout << statistics_.summary() << std::endl;
        recorder_.statistics(statistics_);
        if (!failure.empty()) throw std::runtime_error(failure);
    }

private:
    void watch() {
        uint64_t last_us = nowUs();
        while (!interrupt_.asked() && !quit_ && !done()) {
            const uint64_t now = nowUs();
            handleEvents(now);
            if (gestures_) steer(now, static_cast<float>(now - last_us) * 1e-6f);
            last_us = now;
            if (Session* const session = link_.session(wishes_))
                converse(*session, now);
            else
                SDL_Delay(kLoopWait.count());
            if ((sheets_ || lit_) && now >= next_redraw_us_) {
                next_redraw_us_ = now + kRedrawEveryUs;
                present();
            }
            if (now >= next_title_us_) showTitle(now);
        }
    }

    bool done() const {
        if (options_.frames > 0 && statistics_.frames() >= options_.frames) return true;
        return options_.seconds > 0 && first_us_ > 0 &&
               static_cast<double>(nowUs() - first_us_) >= options_.seconds * 1e6;
    }

    void handleEvents(uint64_t now) {
        SDL_Event event;
        while (SDL_PollEvent(&event) != 0) {
            if (event.type == SDL_QUIT || (event.type == SDL_KEYDOWN && event.key.keysym.sym == SDLK_ESCAPE))
                quit_ = true;
            if (event.type == SDL_WINDOWEVENT) {
                if (event.window.event == SDL_WINDOWEVENT_SIZE_CHANGED) resized_us_ = now;
                if (event.window.event == SDL_WINDOWEVENT_MINIMIZED) hide(true);
                if (event.window.event == SDL_WINDOWEVENT_RESTORED || event.window.event == SDL_WINDOWEVENT_MAXIMIZED)
                    hide(false);
                present(); // exposed, restored, resized: draw again
            }
            people_keys_.handle(event, display_);
            if (event.type == SDL_KEYDOWN && event.key.keysym.sym == SDLK_c) present();
            if (gestures_) gestures_->handle(event, display_);
        }
        if (resized_us_ > 0 && now - resized_us_ > kResizeAfterUs) {
            resized_us_ = 0;
            wishes_.width = static_cast<uint16_t>(std::clamp(display_.width() / wishes_.views, 16, 8192));
            wishes_.height = static_cast<uint16_t>(std::clamp(display_.height(), 16, 8192));
        }
    }

    // A minimised window asks for no pictures.
    void hide(bool hidden) {
        hidden_ = hidden;
        next_pose_us_ = 0; // told at once
    }

    // The camera: along its path until the user takes it.
    void steer(uint64_t now, float seconds) {
        gestures_->passTime(std::min(seconds, 0.1f));
        if (camera_.kind != PathKind::still && !gestures_->touched())
            gestures_->standAt(camera_.at(static_cast<double>(now - start_us_) * 1e-6));
    }

    void converse(Session& session, uint64_t now) {
        if (session.welcomed()) talk(session, now);
        std::optional<Received> newest;
        for (auto message = session.next(kLoopWait); message; message = session.next(milliseconds(0))) {
            if (const auto* error = message->as<wire::Error>()) {
                statistics_.error(*error);
                told_us_ = now;
            } else if (const auto* state = message->as<wire::SceneState>()) {
                paused_ = state->paused();
                viewers_ = state->viewers();
                standstill_ = session.standstill();
                leader_ = session.leader();
                if (paused_ || !standstill_.empty()) link_.heard(now); // a camera that rests gets no frames
            } else if (message->as<wire::Welcome>()) {
                welcome(session.granted());
            } else if (const auto* people = message->as<wire::People>()) {
                people_ = peopleOf(*people);
                present();
            } else if (message->as<wire::LitParticles>()) {
                takeLit(session, *message);
            } else if (message->as<wire::Frame>()) {
                lit_ = false;
                if (newest) statistics_.dropped();
                newest = std::move(message);
            }
        }
        if (newest) show(session, *newest);
        link_.check(statistics_.lastError());
    }

    void welcome(const Granted& granted) {
        statistics_.welcome(granted);
        next_ping_us_ = 0;
        me_ = granted.viewer;
        people_.clear();
        // A welcome to the same scene, after a lost connection: the camera stays where the user left it.
        if (granted.scene == std::exchange(scene_, granted.scene) && gestures_) return;
        camera_ = options_.camera.value_or(CameraPath{options_.path, granted.position, granted.target, granted.fov_y});
        camera_.fov_y = granted.fov_y;
        camera_.keys = options_.keys;
        if (!camera_.keys && !granted.keys.empty()) camera_.keys = std::make_shared<const KeyPath>(granted.keys);
        gestures_.emplace(camera_, options_.wishes.views);
        seen_ = gestures_->pose();
        start_us_ = nowUs();
    }

    // Poses, pushes and pings that are due.
    void talk(Session& session, uint64_t now) {
        if (options_.pause && !std::exchange(pause_sent_, true)) session.sendPaused(true);
        if (hidden_) link_.heard(now); // no frames come, and none are missed
        if (now >= next_pose_us_) {
            Pose pose = gestures_->pose();
            if (wishes_.views == 2) pose.eye_separation = kEyeSeparation;
            sendPose(session, pose);
            next_pose_us_ = now + (hidden_ ? kSecondUs : kPoseEveryUs);
        }
        if (now >= next_ping_us_) {
            session.sendPing();
            statistics_.roundTrip(session.roundTripMs());
            next_ping_us_ = now + kSecondUs;
        }
        while (first_us_ > 0 && impulses_sent_ < options_.impulses.size() &&
               static_cast<double>(now - first_us_) >= options_.impulses[impulses_sent_].seconds * 1e6)
            send(session, options_.impulses[impulses_sent_++].impulse);
        if (now >= next_push_us_) {
            const float seconds = static_cast<float>(now + kPushEveryUs - next_push_us_) * 1e-6f;
            next_push_us_ = now + kPushEveryUs;
            if (const auto impulse = gestures_->takeImpulse(eye(), seconds)) send(session, *impulse);
        }
        if (now >= next_say_us_) {
            next_say_us_ = now + kSayEveryUs;
            session.appear(people_keys_.appearance(eye()));
        }
        if (gestures_->undoAsked()) {
            session.sendUndo();
            statistics_.inputSent();
        }
        if (gestures_->pauseToggled()) {
            session.sendPaused(!paused_);
            statistics_.inputSent();
        }
    }

    void sendPose(Session& session, Pose pose) const {
        if (!options_.redraw) return void(session.sendPose(pose, wishes_.width, wishes_.height, hidden_));
        pose.fov_y = 2 * std::atan(kWider * std::tan(pose.fov_y / 2));
        const auto wider = [](uint16_t pixels) { return uint16_t(std::lround(kWider * float(pixels))); };
        session.sendPose(pose, wider(wishes_.width), wider(wishes_.height), hidden_, 1);
    }

    void send(Session& session, const Impulse& impulse) {
        session.sendImpulse(impulse);
        statistics_.inputSent();
    }

    void show(Session& session, const Received& message) {
        const auto& frame = *message.as<wire::Frame>();
        const int views = static_cast<int>(frame.jpeg_bytes()->size());
        const int width = frame.width(), height = frame.height();
        const uint64_t decode_start = nowUs();
        uint64_t decoded = decode_start;
        const bool whole = display_.update(width * views, height, [&](uint8_t* pixels, int pitch) {
            bool good = true;
            for (int view = 0; view < views; ++view)
                good = good && decoder_.decodeBgra(message.parsed().view(static_cast<uint32_t>(view)), width, height,
                                                   pixels + static_cast<ptrdiff_t>(4) * width * view, pitch);
            decoded = nowUs();
            return good;
        });
        if (!whole) throw std::runtime_error("a picture from the server is broken: " + decoder_.error());
        const auto& position = *frame.position();
        const auto& turn = *frame.orientation();
        seen_.position = {position.x(), position.y(), position.z()};
        seen_.orientation = glm::quat(turn.w(), turn.x(), turn.y(), turn.z());
        seen_.fov_y = frame.fov_y();
        sheets_ = options_.redraw ? Sheets::of(message, decoder_) : std::nullopt;
        if (sheets_ && !display_.take(*sheets_)) sheets_.reset();
        present();
        const uint64_t presented = nowUs();
        session.acknowledge(frame.id());
        link_.heard(presented);

        const FrameRecord record = recordOf(message, static_cast<float>(decoded - decode_start) * 1e-3f, presented);
        statistics_.frame(record);
        recorder_.frame(message);
        if (first_us_ == 0) first_us_ = presented;
        tick_ = record.tick;
    }

    // Particles that the server has lit: they are drawn with the display's next picture.
    void takeLit(Session& session, const Received& message) {
        const auto& lit = *message.as<wire::LitParticles>();
        const lit::Rows* const rows = reader_.read(lit, message.parsed().jpeg);
        if (!rows) throw std::runtime_error("the server sent " + reader_.why());
        painter_->take(lit, *rows);
        lit_ = true;
        sheets_.reset();
        present();
        const uint64_t presented = nowUs();
        session.acknowledge(lit.id());
        link_.heard(presented);
        statistics_.frame(recordOf(message, drawn_ms_, presented, gestures_->pose(), picture_));
        recorder_.picture(picture_);
        if (first_us_ == 0) first_us_ = presented;
        tick_ = lit.tick();
    }

    // What the particles look like from where the camera is.
    void paint() {
        const uint64_t begin = nowUs();
        seen_ = gestures_->pose();
        painter_->draw(seen_, wishes_.width, wishes_.height, picture_);
        drawn_ms_ = static_cast<float>(nowUs() - begin) * 1e-3f;
        display_.update(picture_.width, picture_.height, [&](uint8_t* pixels, int pitch) {
            const uint8_t* from = picture_.rgb.data();
            for (int y = 0; y < picture_.height; ++y)
                for (int x = 0; x < picture_.width; ++x, from += 3) {
                    uint8_t* const to = pixels + static_cast<ptrdiff_t>(y) * pitch + static_cast<ptrdiff_t>(4) * x;
                    to[0] = from[2], to[1] = from[1], to[2] = from[0], to[3] = 255;
                }
            return true;
        });
        mark();
        display_.present();
    }

    // The newest picture; with layers or particles as the camera sees it now.
    void present() {
        if (lit_ && gestures_) return paint();
        mark();
        if (!sheets_) return display_.present();
        display_.present(*sheets_, eye());
        statistics_.redrawn();
    }

    // Camera of what is shown.
    Pose eye() const { return sheets_ ? gestures_->pose() : seen_; }

    // People over the picture; over two eyes none, as on the page.
    void mark() {
        const bool one_eye = wishes_.views == 1 && gestures_;
        display_.mark(one_eye ? marksOf(people_, me_, eye(), display_.area(), people_keys_.cones()) : Marks());
    }

    void showTitle(uint64_t now) {
        next_title_us_ = now + kTitleEveryUs;
        if (!link_.trouble().empty()) return display_.setTitle("brume: reconnecting: " + link_.trouble());
        if (!gestures_) return;                                               // "connecting", from the start
        const uint64_t since = now > 3 * kSecondUs ? now - 3 * kSecondUs : 0; // slow servers too show a rate
        std::string title = fmt::format("brume: {}, {:.1f} fps", scene_, statistics_.recentRate(since));
        if (const auto latency = statistics_.recentLatencyMs(since)) title += fmt::format(", {:.0f} ms", *latency);
        if (!leader_.empty()) title += ", as " + leader_ + " sees it";
        if (sheets_) title += ", redrawn";
        if (lit_) title += fmt::format(", drawn here in {:.0f} ms", drawn_ms_);
        const std::string names = namesOf(people_, me_);
        title += fmt::format(", tick {}{}, {} viewer{}{}{}", tick_, paused_ ? ", paused" : "", viewers_,
                             viewers_ == 1 ? "" : "s", names.empty() ? "" : ": ", names);
        if (!standstill_.empty()) title = fmt::format("brume: {} stands still: {}", scene_, standstill_);
        if (told_us_ > 0 && now - told_us_ < kToldUs)
            title = "brume: " + statistics_.lastError(); // such as: this role may not
        display_.setTitle(title);
    }

    const Options& options_;
    Interrupt& interrupt_;
    Painter* const painter_; // null: pictures come from the server
    LitReader reader_;
    Picture picture_;    // drawn here
    bool lit_ = false;   // true: what is shown is drawn here
    float drawn_ms_ = 0; // time that the last one took
    Recorder recorder_;  // first, so that a folder that cannot be written is told before a window opens
    Statistics statistics_;
    Display display_;
    Wishes wishes_; // the size follows the window
    Link link_;
    JpegDecoder decoder_;
    std::optional<Sheets> sheets_; // the newest picture's, if it has layers
    CameraPath camera_;
    std::optional<Gestures> gestures_; // from the first welcome on
    PeopleKeys people_keys_;
    std::vector<Person> people_;
    uint32_t me_ = 0; // this viewer's id
    Pose seen_;       // camera of the picture that is shown
    std::string scene_;
    std::string standstill_;  // why the scene stands still; empty while ticks come
    std::string leader_;      // person whose camera pictures have; empty: its own
    bool pause_sent_ = false; // true: Options::pause was carried out
    bool quit_ = false, paused_ = false;
    bool hidden_ = false; // true: the window is minimised
    uint32_t viewers_ = 0;
    uint64_t tick_ = 0;
    uint64_t start_us_ = 0, first_us_ = 0; // welcome to the present scene, first frame
    uint64_t next_pose_us_ = 0, next_ping_us_ = 0, next_push_us_ = 0, next_title_us_ = 0, next_redraw_us_ = 0,
             next_say_us_ = 0, resized_us_ = 0, told_us_ = 0;
    size_t impulses_sent_ = 0;
};

} // namespace

void runWindow(const Options& options, Interrupt& interrupt, Painter* painter) {
    WindowedViewer(options, interrupt, painter).run();
}

} // namespace brume::client
