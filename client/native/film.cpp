#include "client/native/film.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "client/native/film_writer.h"
#include "client/native/http_get.h"
#include "client/native/link.h"
#include "common/scene_limits.h"

namespace brume::client {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kLook{20};
constexpr uint64_t kMostPictureBytes = 64u << 20;
constexpr milliseconds kPictureWithin{120'000}; // shaders may be compiled first
constexpr int kMostTries = 24;                  // tries of one picture, while the server is busy or compiles shaders
constexpr std::chrono::seconds kBetweenTries{5};
constexpr uint64_t kTellEvery = 100; // frames

// Enters once: for the scene's own camera, and to pause.
Granted enter(const Options& options, Interrupt& interrupt) {
    Link link(options, false);
    std::string last_error;
    bool asked = false;
    while (!interrupt.asked()) {
        Session* const session = link.session(options.wishes);
        if (!session) {
            std::this_thread::sleep_for(kLook);
            continue;
        }
        if (session->welcomed() && !asked) {
            if (options.pause) session->sendPaused(true);
            session->sendPose(Pose{}, 0, 0, true);
            asked = true;
        }
        const auto message = session->next(milliseconds(50));
        if (!message) link.check(last_error);
        if (!message) continue;
        if (const auto* error = message->as<wire::Error>()) last_error = error->text() ? error->text()->str() : "";
        if (asked && !last_error.empty()) throw std::runtime_error("the scene is not paused: " + last_error);
        const auto* state = message->as<wire::SceneState>();
        if (!session->welcomed() || (options.pause && !(state && state->paused()))) continue;
        Granted granted = session->granted();
        link.leave("a film begins");
        return granted;
    }
    throw std::runtime_error("interrupted");
}

CameraPath pathOf(const Options& options, const Granted& granted) {
    CameraPath path =
        options.camera.value_or(CameraPath{options.path, granted.position, granted.target, granted.fov_y});
    path.fov_y = granted.fov_y;
    path.keys = options.keys;
    if (path.kind == PathKind::keys && !path.keys && granted.keys.empty())
        throw std::runtime_error("the scene has no key views: --path FILE takes those of a file");
    if (path.kind == PathKind::keys && !path.keys) path.keys = std::make_shared<const KeyPath>(granted.keys);
    return path;
}

// The picture as the server makes it for GET /snapshot: at rest, and within the scene's error whatever the load.
std::string request(const Endpoint& server, const Pose& pose, const Wishes& wishes, std::string_view format) {
    const std::string base = server.path.substr(0, server.path.find_last_of('/')); // the page's, beside the socket
    // As far away as float32 needs to tell the direction, and within what the server takes.
    const glm::vec3 size = glm::abs(pose.position);
    const float most = std::max({size.x, size.y, size.z});
    const float reach = std::min(std::max(most, 1.0f), std::max(float(limits::kPlace.hi) - most, 1.0f));
    const glm::vec3 target = pose.position + reach * (pose.orientation * glm::vec3(0, 0, -1));
    return base + fmt::format("/snapshot.{}?w={}&h={}&keep_size=1&position={},{},{}&target={},{},{}&fov={}{}{}", format,
                              wishes.width, wishes.height, pose.position.x, pose.position.y, pose.position.z, target.x,
                              target.y, target.z, pose.fov_y,
                              wishes.quality > 0 && format == "jpg" ? fmt::format("&quality={}", wishes.quality) : "",
                              wishes.view == "picture" ? "" : "&view=" + wishes.view);
}

std::string picture(const Options& options, const std::string& path, Interrupt& interrupt) {
    for (int tries = 1;; ++tries) {
        try {
            return httpGet(options.servers.front(), path, kPictureWithin, kMostPictureBytes);
        } catch (const std::runtime_error& error) {
            const bool later = std::string_view(error.what()).find("HTTP 503") != std::string_view::npos;
            if (!later || tries == kMostTries || interrupt.asked()) throw;
        }
        for (auto waited = milliseconds(0); waited < kBetweenTries && !interrupt.asked(); waited += kLook)
            std::this_thread::sleep_for(kLook);
    }
}

} // namespace

void runFilm(const Options& options, Interrupt& interrupt) {
    FilmWriter writer(options.out, options.fps, options.wishes.width, options.wishes.height);
    const CameraPath path = pathOf(options, enter(options, interrupt));
    const double own = path.kind == PathKind::keys ? path.keys->seconds() : secondsOf(path.kind);
    const double seconds = options.seconds > 0 ? options.seconds : own;
    // The last frame of keys is at the last key. A round has none at its end, which is its begin.
    const auto frames = uint64_t(std::lround(seconds * double(options.fps))) + (path.kind == PathKind::keys ? 1 : 0);
    const uint64_t wanted = options.frames > 0 ? std::min(options.frames, frames) : frames;
    uint64_t made = 0;
    for (; made < wanted && !interrupt.asked(); ++made) {
        const Pose pose = path.at(double(made) / double(options.fps));
        writer.add(
            picture(options, request(options.servers.front(), pose, options.wishes, writer.format()), interrupt));
        if ((made + 1) % kTellEvery == 0) std::cerr << fmt::format("brume-client: {} of {} frames\n", made + 1, wanted);
    }
    writer.finish();
    std::cout << fmt::format("{}: {} frames of {}x{}, {:.2f} s at {} a second\n", options.out.string(), made,
                             options.wishes.width, options.wishes.height, double(made) / double(options.fps),
                             options.fps)
              << std::flush;
    if (made < wanted) throw std::runtime_error(fmt::format("interrupted after {} of {} frames", made, wanted));
}

} // namespace brume::client
