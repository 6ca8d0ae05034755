// The window of the native client: pictures with layers with depth are drawn as seen from where its camera is by now,
// against what the server draws there.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "client/native/display.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test {
namespace {

using std::chrono::steady_clock;

constexpr uint16_t kWidth = 320, kHeight = 180;

// Mean absolute difference of the display's drawing area and a picture, in steps of 1/255.
double difference(const client::Display& display, const client::Picture& picture) {
    const std::vector<uint8_t> shown = display.read();
    if (shown.size() != 4 * picture.rgb.size() / 3) return INFINITY;
    double sum = 0;
    for (size_t i = 0; i < shown.size() / 4; ++i)
        for (size_t c = 0; c < 3; ++c) sum += std::abs(double(shown[4 * i + 2 - c]) - double(picture.rgb[3 * i + c]));
    return sum / double(picture.rgb.size());
}

// The first frame of a paused scene from `pose` that has layers, or needs none.
std::optional<client::Received> frameFrom(client::Session& session, const Pose& pose, uint8_t layers) {
    const auto wanted = session.sendPose(pose, kWidth, kHeight, false, layers);
    for (const auto end = steady_clock::now() + kPatience; steady_clock::now() < end;) {
        auto message = session.next(milliseconds(100));
        const auto* frame = message ? message->as<wire::Frame>() : nullptr;
        if (!frame) continue;
        session.acknowledge(frame->id());
        if (frame->pose_seq() >= *wanted && frame->quality() >= 80 && (layers == 0 || frame->layers())) return message;
    }
    return {};
}

TEST(Window, RedrawsAPictureAsTheServerDrawsItThere) {
    setenv("SDL_VIDEODRIVER", "dummy", 1);
    client::Display display("test", kWidth, kHeight);
    client::JpegDecoder decoder;
    for (const auto& [scene, target] : {std::pair{"cloud", glm::vec3(0)}, std::pair{"props", glm::vec3(0, 3, 0)}}) {
        RunningServer server({"--scene", scene});
        Watcher watcher(server.endpoint());
        setPaused(watcher, true);
        client::Session& session = watcher.session;
        const Pose made = lookAt(target + glm::vec3(0, 2, 20), target, 0.8f);
        const Pose there = lookAt(target + glm::vec3(0.8f, 2, 19), target, 0.65f); // within what was drawn
        const auto frame = frameFrom(session, made, 1);
        ASSERT_TRUE(frame) << scene;
        const auto sheets = client::Sheets::of(*frame, decoder);
        ASSERT_TRUE(sheets) << scene;
        client::Picture picture, truth;
        ASSERT_TRUE(decoder.decode(frame->parsed().view(0), kWidth, kHeight, picture));
        ASSERT_TRUE(display.take(*sheets)) << scene;
        display.present(*sheets, made);
        EXPECT_LT(difference(display, picture), 2.5) << scene << ", from its own place";
        const auto later = frameFrom(session, there, 0);
        ASSERT_TRUE(later) << scene;
        ASSERT_TRUE(decoder.decode(later->parsed().view(0), kWidth, kHeight, truth));
        Pose old = made;
        old.fov_y = there.fov_y;
        display.present(*sheets, old);
        const double stays = difference(display, truth);
        display.present(*sheets, there);
        // SDL's software draws edges of triangles twice, which shows where many are half transparent.
        EXPECT_LT(difference(display, truth), 0.75 * stays) << scene << ", where the old picture errs by " << stays;
    }
}

} // namespace
} // namespace brume::test
