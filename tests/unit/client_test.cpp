// The client's parts that need no server.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "client/native/camera_path.h"
#include "client/native/controls.h"
#include "client/native/endpoint.h"
#include "client/native/film.h"
#include "client/native/link.h"
#include "client/native/options.h"
#include "client/native/statistics.h"

namespace brume::client {
namespace {

std::optional<Options> parsed(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "brume-client");
    int exit_code = 0;
    testing::internal::CaptureStderr();
    auto options = parseOptions(static_cast<int>(arguments.size()), arguments.data(), exit_code);
    const std::string err = testing::internal::GetCapturedStderr();
    EXPECT_EQ(options.has_value(), exit_code == 0) << err;
    EXPECT_EQ(options.has_value(), err.empty()) << err;
    return options;
}

void expectNear(glm::vec3 a, glm::vec3 b, float tolerance) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}

glm::vec3 aheadOf(const Pose& pose) { return pose.orientation * glm::vec3(0, 0, -1); }

TEST(Endpoint, UrlsOfEveryShape) {
    EXPECT_EQ(parseUrl("ws://cloud.example:81").url(), "ws://cloud.example:81/ws");
    EXPECT_EQ(parseUrl("ws://cloud.example").url(), "ws://cloud.example:8080/ws");
    EXPECT_EQ(parseUrl("ws://cloud.example/").url(), "ws://cloud.example:8080/ws");
    EXPECT_EQ(parseUrl("ws://[::1]:81/other").url(), "ws://[::1]:81/other");
    EXPECT_EQ(parseUrl("ws://[::1]:81/other").host, "::1");
    EXPECT_EQ(parseUrl("ws://[::1]:81/other").authority(), "[::1]:81");
    EXPECT_EQ(parseUrl("ws://cloud.example:81").authority(), "cloud.example:81");
    EXPECT_EQ(parseUrl("wss://cloud.example:443").url(), "wss://cloud.example:443/ws");
    EXPECT_TRUE(parseUrl("wss://[::1]/").tls);
    EXPECT_FALSE(parseUrl("ws://cloud").tls);
    EXPECT_EQ(parseUrl("http://127.0.0.1:8080").url(), "ws://127.0.0.1:8080/ws");
    EXPECT_EQ(parseUrl("https://cloud.example:81/show/?eyes=side").url(), "wss://cloud.example:81/show/ws");
    EXPECT_EQ(parseUrl("http://cloud.example/").url(), "ws://cloud.example:80/ws");
    for (const char* page : {"https://cloud.example/clouds/brume/", "https://cloud.example/clouds/brume",
                             "https://cloud.example/clouds/brume/embed.html?controls=none"})
        EXPECT_EQ(parseUrl(page).url(), "wss://cloud.example:443/clouds/brume/ws") << page;
    for (const char* bad :
         {"", "cloud", "ftp://cloud", "http:/cloud", "http://a:0", "wss:/cloud", "ws://", "ws://:80", "ws://a:0",
          "ws://a:65536", "ws://a:8x", "ws://a:", "ws://[::1", "ws://[::1]80", "ws://a b", "ws://a\n"})
        EXPECT_THROW(parseUrl(bad), std::invalid_argument) << bad;
}

TEST(Endpoint, WhereAGoodbyeSends) {
    const std::vector<std::pair<const char*, const char*>> good{
        {"https://cloud.example", "wss://cloud.example:443/ws"},
        {"http://cloud.example/", "ws://cloud.example:80/ws"},
        {"http://cloud.example:81/show/?eyes=side#top", "ws://cloud.example:81/show/ws"},
        {"https://[::1]:81/show/index.html", "wss://[::1]:81/show/ws"},
        {"wss://cloud.example/show/socket", "wss://cloud.example:443/show/socket"},
        {"ws://cloud.example", "ws://cloud.example:80/ws"}};
    for (const auto& [url, socket] : good) {
        ASSERT_TRUE(parseGoTo(url)) << url;
        EXPECT_EQ(parseGoTo(url)->url(), socket);
    }
    for (const char* bad :
         {"", "cloud", "ftp://cloud", "httpx://cloud", "http:", "http://", "https://a:0", "file:///etc/passwd"})
        EXPECT_FALSE(parseGoTo(bad)) << bad;
}

TEST(Options, GoodOnes) {
    const auto options =
        parsed({"--url", "ws://h:1", "--size", "800x450", "--stereo", "--path", "fly", "--camera", "1,2,3,-4,5e-1,6",
                "--impulse", "2:0,0,5,0,0,-2,1.5", "--impulse", "0.5:0,0,5,0,1,0,-1"});
    ASSERT_TRUE(options);
    ASSERT_EQ(options->servers.size(), 1u);
    EXPECT_EQ(options->servers[0].url(), "ws://h:1/ws");
    EXPECT_EQ(options->wishes.width, 800);
    EXPECT_EQ(options->wishes.height, 450);
    EXPECT_EQ(options->wishes.views, 2);
    ASSERT_TRUE(options->camera);
    EXPECT_EQ(options->camera->kind, PathKind::fly);
    EXPECT_EQ(options->camera->position, glm::vec3(1, 2, 3));
    EXPECT_EQ(options->camera->target, glm::vec3(-4, 0.5f, 6));
    ASSERT_EQ(options->impulses.size(), 2u); // by time
    EXPECT_EQ(options->impulses[0].seconds, 0.5);
    EXPECT_EQ(options->impulses[1].impulse.direction, glm::vec3(0, 0, -1)); // unit
    EXPECT_EQ(options->impulses[1].impulse.strength, 1.5f);
}

TEST(Options, SeveralServersAreTriedInTheirOrder) {
    const auto options = parsed({"--url", "ws://a:1,https://b/show/,ws://[::1]"});
    ASSERT_TRUE(options);
    ASSERT_EQ(options->servers.size(), 3u);
    EXPECT_EQ(options->servers[0].url(), "ws://a:1/ws");
    EXPECT_EQ(options->servers[1].url(), "wss://b:443/show/ws");
    EXPECT_EQ(options->servers[2].url(), "ws://[::1]:8080/ws");
    EXPECT_EQ(parsed({})->servers[0].url(), "ws://127.0.0.1:8080/ws");
}

TEST(Options, BadOnesAreRefused) {
    const std::vector<std::vector<const char*>> bad{{"--size", "640"},
                                                    {"--size", "8x8"},
                                                    {"--size", "640x360x2"},
                                                    {"--size", "-1x10"},
                                                    {"--camera", "1,2,3"},
                                                    {"--camera", "0,0,0,0,0,0"},
                                                    {"--camera", "a,0,0,1,1,1"},
                                                    {"--camera", "nan,0,0,1,1,1"},
                                                    {"--camera", "1,2,3,4,5,6,7"},
                                                    {"--impulse", "1:2"},
                                                    {"--impulse", ""},
                                                    {"--impulse", "-1:0,0,0,0,0,1,1"},
                                                    {"--impulse", "1:0,0,0,0,0,0,1"},
                                                    {"--path", "loop"},
                                                    {"--quality", "101"},
                                                    {"--frames", "-1"},
                                                    {"--timeout", "0"},
                                                    {"--url", "ws://a,b"},
                                                    {"--url", ""},
                                                    {"--out", "x"},
                                                    {"stray"}};
    for (const auto& arguments : bad) EXPECT_FALSE(parsed(arguments)) << arguments[0] << " " << arguments.back();
}

TEST(Backoff, DoublesToASecondAndKeepsWhatTheServerAsksFor) {
    Backoff longest, shortest;
    for (const double step : {0.1, 0.2, 0.4, 0.8, 1.0, 1.0}) {
        EXPECT_EQ(longest.next(0, 1), step);
        EXPECT_EQ(shortest.next(0, 0), step / 2);
    }
    EXPECT_GE(longest.next(5, 0), 5);
    EXPECT_LE(longest.next(5, 1), 5.2);
    EXPECT_LE(longest.next(1e9, 1), 301) << "a server may not send away for ever";
    longest.reset();
    EXPECT_EQ(longest.next(0, 1), 0.1);
}

TEST(Film, HasItsOptions) {
    const auto file = std::filesystem::path(testing::TempDir()) / "film_keys.toml";
    std::ofstream(file) << "[[key]]\nposition = [0, 0, 9]\n[[key]]\nposition = [0, 0, 5]\nseconds = 2\n";
    const auto film = parsed({"--headless", "--path", file.c_str(), "--out", "a/film.mp4", "--fps", "24"});
    ASSERT_TRUE(film);
    EXPECT_TRUE(film->film);
    EXPECT_EQ(film->path, PathKind::keys);
    ASSERT_TRUE(film->keys);
    EXPECT_EQ(film->keys->seconds(), 2);
    EXPECT_EQ(film->fps, 24u);
    const CameraPath path{.kind = PathKind::keys, .keys = film->keys};
    expectNear(path.at(1).position, {0, 0, 7}, 1e-6f);
    EXPECT_TRUE(parsed({"--headless", "--path", "orbit", "--out", "turn-%04d.exr"})->film);
    EXPECT_FALSE(parsed({"--headless", "--frames", "3", "--out", "folder"})->film);
    EXPECT_EQ(parsed({"--path", "keys"})->path, PathKind::keys) << "in a window, too";
    const std::vector<std::vector<const char*>> bad{
        {"--path", "orbit", "--out", "film.mp4"}, // in a window
        {"--headless", "--out", "film.mp4"},      // of what?
        {"--headless", "--path", "orbit", "--out", "film.mp4", "--size", "641x360"},
        {"--headless", "--path", "orbit", "--out", "film.mp4", "--stereo"},
        {"--headless", "--path", "orbit", "--out", "film.mp4", "--fps", "0"},
        {"--headless", "--path", "orbit", "--out", "frames-%04d.tga"},
        {"--headless", "--path", "orbit", "--out", "frames-%s.png"},
        {"--headless", "--path", "orbit", "--out", "frames-%d-%d.png"},
        {"--headless", "--path", "no-such-file.toml", "--out", "film.mp4"},
        {"--headless", "--path", file.parent_path().c_str(), "--out", "film.mp4"}};
    for (const auto& arguments : bad) EXPECT_FALSE(parsed(arguments)) << arguments[arguments.size() - 1];
}

TEST(Film, NumbersItsPictures) {
    EXPECT_EQ(numbered("a/frames-%04d.png", 7), "a/frames-0007.png");
    EXPECT_EQ(numbered("%d.jpg", 12), "12.jpg");
    EXPECT_EQ(numbered("f%03d.exr", 12345), "f12345.exr");
}

TEST(CameraPath, EachStartsWhereItIsTold) {
    CameraPath path;
    path.position = {3, 4, 12};
    path.target = {1, 0, 0};
    for (const PathKind kind : {PathKind::still, PathKind::orbit, PathKind::fly}) {
        path.kind = kind;
        expectNear(path.at(0).position, path.position, 1e-5f);
        for (double t = 0; t < 60; t += 0.7) EXPECT_TRUE(isUsable(path.at(t))) << "kind " << int(kind) << " at " << t;
    }
}

TEST(CameraPath, AnOrbitKeepsItsDistanceAndItsTarget) {
    CameraPath path{PathKind::orbit, {3, 4, 12}, {1, 0, 0}, 0.8f};
    for (double t = 0; t < 20; t += 1.3) {
        const Pose pose = path.at(t);
        EXPECT_NEAR(glm::length(pose.position - path.target), glm::length(path.position - path.target), 1e-4f);
        expectNear(aheadOf(pose), glm::normalize(path.target - pose.position), 1e-5f);
    }
    expectNear(path.at(20).position, path.position, 1e-4f);
    expectNear(path.at(10).position, {-1, 4, -12}, 1e-4f); // half a turn: mirrored at the axis through the target
}

TEST(CameraPath, AWalkStaysNearItsStart) {
    const CameraPath path{PathKind::walk, {3, 4, 12}, {1, 0, 0}, 0.8f};
    const float distance = glm::distance(path.position, path.target);
    float least = 1;
    for (int i = 0; i < 100; ++i) {
        const Pose pose = path.at(kWalkSeconds * i / 100);
        EXPECT_NEAR(glm::distance(pose.position, path.position), 0.12f * distance, 1e-4f);
        EXPECT_FLOAT_EQ(pose.position.y, path.position.y);
        const glm::vec3 forward = pose.orientation * glm::vec3(0, 0, -1);
        least = std::min(least, glm::dot(forward, glm::normalize(path.target - path.position)));
    }
    EXPECT_GT(least, 0.8f) << "it looks toward the target";
    EXPECT_LT(least, 0.95f) << "and about";
}

TEST(CameraPath, AFlightPassesTheTarget) {
    CameraPath path{PathKind::fly, {0, 2, 26}, {0, 0, 0}, 0.8f};
    float nearest = 1e9f;
    for (double t = 0; t < 40; t += 0.05) nearest = std::min(nearest, glm::length(path.at(t).position - path.target));
    EXPECT_LT(nearest, 0.3f);
}

TEST(CursorRay, MiddleAndCorners) {
    const Pose pose = lookAt({1, 2, 3}, {4, 0, -5}, 0.9f);
    expectNear(cursorRay(pose, 0.5f, 0.5f, 1.5f).direction, aheadOf(pose), 1e-6f);
    EXPECT_EQ(cursorRay(pose, 0, 0, 1.5f).origin, pose.position);
    // The middle of the upper edge is half the vertical angle above the axis.
    const glm::vec3 top = cursorRay(pose, 0.5f, 0, 1.5f).direction;
    EXPECT_NEAR(std::acos(glm::dot(top, aheadOf(pose))), 0.45f, 1e-5f);
    EXPECT_GT(top.y, aheadOf(pose).y);
    const glm::vec3 right = pose.orientation * glm::vec3(1, 0, 0);
    EXPECT_GT(glm::dot(cursorRay(pose, 1, 0.5f, 1.5f).direction, right), 0);
}

TEST(Controls, StartAsTheCameraDoes) {
    const Controls controls({3, 4, 12}, {1, 0, 0}, 0.8f);
    const Pose expected = lookAt({3, 4, 12}, {1, 0, 0}, 0.8f);
    EXPECT_EQ(controls.pose().position, expected.position);
    EXPECT_NEAR(std::abs(glm::dot(controls.pose().orientation, expected.orientation)), 1, 1e-6f);
}

TEST(Controls, TurningOrbitsTheTarget) {
    const glm::vec3 target(1, 0, 0);
    Controls controls({3, 4, 12}, target, 0.8f);
    const float distance = glm::length(controls.pose().position - target);
    for (int i = 0; i < 50; ++i) {
        controls.turn(0.3f, i < 25 ? 0.2f : -0.2f); // into both poles, which it does not pass
        const Pose pose = controls.pose();
        ASSERT_TRUE(isUsable(pose));
        EXPECT_NEAR(glm::length(pose.position - target), distance, 1e-3f);
        expectNear(aheadOf(pose), (target - pose.position) / distance, 1e-4f);
        EXPECT_GT((pose.orientation * glm::vec3(0, 1, 0)).y, 0); // never upside down
    }
}

TEST(Controls, FlyingTurnsOnTheSpotAndMovesAhead) {
    Controls controls({0, 0, 10}, {0, 0, 0}, 0.8f);
    controls.toggleFly();
    controls.turn(0.5f, 0.1f);
    EXPECT_EQ(controls.pose().position, glm::vec3(0, 0, 10));
    EXPECT_GT(aheadOf(controls.pose()).x, 0); // to the right
    EXPECT_GT(aheadOf(controls.pose()).y, 0); // and up
    const glm::vec3 ahead = aheadOf(controls.pose());
    controls.move({0, 0, 1}, 2);
    expectNear(controls.pose().position, glm::vec3(0, 0, 10) + ahead * (2 * controls.speed()), 1e-4f);
}

TEST(Controls, TheWheelComesNearer) {
    Controls controls({0, 0, 10}, {0, 0, 0}, 0.8f);
    controls.wheel(1);
    EXPECT_NEAR(controls.pose().position.z, 10 / 1.1f, 1e-4f);
    for (int i = 0; i < 1000; ++i) controls.wheel(1);
    EXPECT_GT(controls.pose().position.z, 0); // never through the target
}

TEST(Statistics, TellTheLastMeasuredErrorThatAFrameTold) {
    Statistics statistics("ws://example/ws");
    FrameRecord record;
    record.tick = 1;
    statistics.frame(record);
    EXPECT_TRUE(statistics.json()["picture_error"].is_null());
    EXPECT_EQ(statistics.summary().find("measured"), std::string::npos);
    record.error = 0.00390625f, record.error_low = 0.001953125f, record.error_high = 0.0078125f;
    statistics.frame(record);
    statistics.frame({});
    const nlohmann::json expected{{"relative_rmse", 0.00390625}, {"low", 0.001953125}, {"high", 0.0078125}};
    EXPECT_EQ(statistics.json()["picture_error"], expected);
    EXPECT_NE(statistics.summary().find("measured: 0.39 % (0.2 to 0.78)"), std::string::npos) << statistics.summary();
}

TEST(Percentile, NearestRank) {
    EXPECT_FALSE(percentile({}, 0.5));
    EXPECT_EQ(percentile({7}, 0.99), 7);
    std::vector<float> hundred(100);
    for (size_t i = 0; i < hundred.size(); ++i) hundred[99 - i] = float(i + 1);
    EXPECT_EQ(percentile(hundred, 0.5), 50);
    EXPECT_EQ(percentile(hundred, 0.95), 95);
    EXPECT_EQ(percentile(hundred, 1.0), 100);
    EXPECT_EQ(percentile(hundred, 0), 1);
}

} // namespace
} // namespace brume::client
