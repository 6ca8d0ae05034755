// The path through key views: closed forms, and the table that the page is held to as well.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <span>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "common/scene_camera.h"
#include "common/scene_text.h"
#include "tests/unit/scene_file.h"

namespace brume::camera_keys_test {
namespace {

constexpr double kPi = std::numbers::pi;

CameraKey keyAt(glm::vec3 position, glm::vec3 target, float seconds = 1, float fov_y = 0.8f) {
    return {position, target, fov_y, seconds};
}

void expectNear(const CameraView& a, const CameraView& b, double tolerance) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a.position[i], b.position[i], tolerance);
    EXPECT_NEAR(std::remainder(a.yaw - b.yaw, 2 * kPi), 0, tolerance);
    EXPECT_NEAR(a.pitch, b.pitch, tolerance);
    EXPECT_NEAR(a.distance, b.distance, tolerance);
    EXPECT_NEAR(a.fov_y, b.fov_y, tolerance);
}

// How fast the view changes: m/s and rad/s together.
double speedAt(const KeyPath& path, double seconds) {
    constexpr double kStep = 1e-6;
    const CameraView a = path.at(seconds - kStep / 2), b = path.at(seconds + kStep / 2);
    return (glm::distance(a.position, b.position) + std::abs(a.yaw - b.yaw) + std::abs(a.pitch - b.pitch) +
            std::abs(a.fov_y - b.fov_y)) /
           kStep;
}

std::span<const CameraKey> firstOf(const std::vector<CameraKey>& keys, size_t count) {
    return std::span<const CameraKey>(keys).first(count);
}

std::vector<CameraKey> ring(int keys, double turns = 1) {
    std::vector<CameraKey> all;
    for (int i = 0; i <= keys * turns; ++i) {
        const double angle = 2 * kPi * i / keys;
        all.push_back(keyAt({float(10 * std::sin(angle)), 2, float(10 * std::cos(angle))}, {0, 2, 0}));
    }
    return all;
}

const std::vector<CameraKey> kUneven{keyAt({0, 2, 26}, {0, 0, 0}), keyAt({10, 2, 20}, {0, 1, 0}, 1.5f),
                                     keyAt({18, 6, 4}, {0, 2, -2}, 4, 0.5f),
                                     keyAt({12, 12, -14}, {1, 0, 1}, 2.5f, 1.2f), keyAt({-3, 1, -9}, {0, 1, 0}, 0.5f)};

TEST(KeyPath, PassesEachKeyAtItsTimeAndStaysAtTheEnds) {
    const KeyPath path(kUneven);
    double time = 0;
    for (size_t i = 0; i < kUneven.size(); ++i) {
        time += i == 0 ? 0 : double(kUneven[i].seconds);
        EXPECT_EQ(path.timeOf(i), time);
        expectNear(path.at(time), viewOf(kUneven[i]), 1e-12);
    }
    EXPECT_EQ(path.seconds(), 8.5);
    expectNear(path.at(-3), viewOf(kUneven.front()), 1e-12);
    expectNear(path.at(99), viewOf(kUneven.back()), 1e-12);
    const KeyPath one(firstOf(kUneven, 1));
    EXPECT_EQ(one.seconds(), 0);
    expectNear(one.at(1), viewOf(kUneven.front()), 1e-12);
}

TEST(KeyPath, BeginsAndEndsAtRestWithoutJumpsOfItsSpeed) {
    for (const size_t count : {2, 3, 5}) {
        const KeyPath path(firstOf(kUneven, count));
        EXPECT_LT(speedAt(path, 1e-5), 2e-2) << count << ": at rest first";
        EXPECT_LT(speedAt(path, path.seconds() - 1e-5), 2e-2) << count << ": at rest last";
        for (size_t i = 1; i + 1 < count; ++i) {
            const double at = path.timeOf(i), before = speedAt(path, at - 1e-5), behind = speedAt(path, at + 1e-5);
            EXPECT_NEAR(before, behind, 1e-3 * before) << "key " << i;
            EXPECT_GT(before, 0.1) << "it goes on";
        }
    }
}

// From rest to rest the smooth step 3 u^2 - 2 u^3; three on a line with even times are passed with their mean speed.
TEST(KeyPath, HasClosedFormsOnALine) {
    const std::vector<CameraKey> keys{keyAt({0, 0, 0}, {0, 0, -1}), keyAt({6, 0, 0}, {6, 0, -1}, 2),
                                      keyAt({12, 0, 0}, {12, 0, -1}, 2)};
    const KeyPath two(firstOf(keys, 2)), three(keys);
    for (const double u : {0.1, 0.25, 0.5, 0.8})
        EXPECT_NEAR(two.at(2 * u).position.x, 6 * (3 * u * u - 2 * u * u * u), 1e-12) << u;
    EXPECT_NEAR(speedAt(three, 2), 3, 1e-5);
    for (const double u : {0.1, 0.25, 0.5, 0.8})
        EXPECT_NEAR(three.at(2 * u).position.x, 6 * (2 * u * u - u * u * u), 1e-12) << u;
}

TEST(KeyPath, StandsStillBetweenEqualKeysAndDoesNotShootBeyondATurn) {
    const std::vector<CameraKey> keys{keyAt({0, 0, 9}, {0, 0, 0}), keyAt({0, 0, 4}, {0, 0, 0}, 2),
                                      keyAt({0, 0, 4}, {0, 0, 0}, 3), keyAt({0, 0, 9}, {0, 0, 0}, 0.5f, 0.4f)};
    const KeyPath path(keys);
    for (double t = 2; t <= 5; t += 0.1) expectNear(path.at(t), viewOf(keys[1]), 1e-12);
    const KeyPath turns(std::vector{keys[0], keys[1], keys[3]});
    for (double t = 0; t <= turns.seconds(); t += 0.01) {
        const CameraView view = turns.at(t);
        EXPECT_GE(view.position.z, 4 - 1e-12);
        EXPECT_LE(view.position.z, 9 + 1e-12);
        EXPECT_GE(view.fov_y, 0.4 - 1e-7);
        EXPECT_LE(view.fov_y, 0.8 + 1e-7);
    }
}

// In the middle between two inner keys of n on a circle the curve is at R (cos(a/2) + sin(a) sin(a/2) / 4), a = 2 pi /
// n.
TEST(KeyPath, StaysNearACircleOfKeysAndLooksAtItsMiddle) {
    const KeyPath path(ring(8));
    const double a = kPi / 4, middle = 10 * (std::cos(a / 2) + std::sin(a) * std::sin(a / 2) / 4);
    for (const double t : {2.5, 3.5, 4.5}) {
        const glm::dvec3 at = path.at(t).position;
        EXPECT_NEAR(std::hypot(at.x, at.z), middle, 1e-5);
    }
    for (double t = 0; t <= 8; t += 0.01) {
        const CameraView view = path.at(t);
        EXPECT_NEAR(std::hypot(view.position.x, view.position.z), 10, 0.1) << t;
        EXPECT_NEAR(view.position.y, 2, 1e-6);
        EXPECT_NEAR(view.pitch, 0, 1e-6);
        const glm::dvec3 ahead(-std::sin(view.yaw), 0, -std::cos(view.yaw)), in = -view.position + glm::dvec3(0, 2, 0);
        EXPECT_GT(glm::dot(ahead, glm::normalize(in)), std::cos(0.02)) << t;
    }
}

// Round and round: yaw goes on growing by a key's part of a turn, never the long way back.
TEST(KeyPath, TurnsTheShorterWayWithALevelHorizon) {
    const KeyPath path(ring(8, 3));
    EXPECT_NEAR(path.at(path.seconds()).yaw - path.at(0).yaw, 6 * kPi, 1e-5);
    double before = path.at(0).yaw;
    for (double t = 0; t <= path.seconds(); t += 0.01) {
        const CameraView view = path.at(t);
        EXPECT_GE(view.yaw, before - 1e-9);
        EXPECT_LT(view.yaw - before, 0.02) << t;
        before = view.yaw;
        const Pose pose = poseOf(view);
        EXPECT_TRUE(isUsable(pose));
        EXPECT_NEAR((pose.orientation * glm::vec3(1, 0, 0)).y, 0, 1e-6f) << "level";
    }
}

TEST(KeyPath, ShowsKeysAsACameraThatLooksAtItsTarget) {
    for (const CameraKey& key : kUneven) {
        const Pose pose = poseOf(viewOf(key)), same = lookAt(key.position, key.target, key.fov_y);
        EXPECT_EQ(pose.position, same.position);
        EXPECT_NEAR(std::abs(glm::dot(pose.orientation, same.orientation)), 1, 1e-6f);
    }
}

glm::vec3 vectorOf(const nlohmann::json& v) { return {v[0].get<float>(), v[1].get<float>(), v[2].get<float>()}; }

// client/web/test/camera-keys.test.ts reads the same table.
TEST(KeyPath, IsThatOfTheSharedTable) {
    std::ifstream in("protocol/examples/camera_path.json"); // tests run in the source folder
    const auto paths = nlohmann::json::parse(in);
    ASSERT_GE(paths.size(), 5u);
    for (const auto& example : paths) {
        SCOPED_TRACE(example["name"].get<std::string>());
        std::vector<CameraKey> keys;
        for (const auto& key : example["keys"])
            keys.push_back({vectorOf(key["position"]), vectorOf(key["target"]), key["fov_y"], key["seconds"]});
        const KeyPath path(keys);
        EXPECT_NEAR(path.seconds(), example["seconds"].get<double>(), 1e-12);
        for (const auto& view : example["views"]) {
            SCOPED_TRACE(view["seconds"].get<double>());
            const auto& p = view["position"];
            const CameraView is = path.at(view["seconds"]);
            expectNear(is,
                       {.position = {p[0], p[1], p[2]},
                        .yaw = view["yaw"],
                        .pitch = view["pitch"],
                        .distance = view["distance"],
                        .fov_y = view["fov_y"]},
                       1e-9);
        }
    }
}

// ---- files ----

std::string problemOf(const std::string& text, const std::string& name = "keys.toml") {
    const auto file = test::written(text).parent_path() / name;
    std::ofstream(file) << text;
    try {
        loadCameraKeys(file);
    } catch (const SceneError& error) {
        return std::string(error.what()).substr(file.string().size());
    }
    return {};
}

const std::string kTwo = "[[camera.key]]\nposition = [1, 2, 3]\ntarget = [0, 0, 0]\n"
                         "[[camera.key]]\nposition = [3, 2, 1]\ntarget = [0, 1, 0]\nfov_y = 0.5\nseconds = 4\n";

TEST(CameraKeys, AreReadAndWrittenWithAScene) {
    const Scene scene = sceneOf(kTwo, "a.toml");
    ASSERT_EQ(scene.camera_keys.size(), 2u);
    EXPECT_EQ(scene.camera_keys[1].position, glm::vec3(3, 2, 1));
    EXPECT_EQ(scene.camera_keys[1].target, glm::vec3(0, 1, 0));
    EXPECT_EQ(scene.camera_keys[1].fov_y, 0.5f);
    EXPECT_EQ(scene.camera_keys[1].seconds, 4);
    EXPECT_EQ(scene.camera.position, SceneCamera{}.position) << "the camera is where it would be without";
    const std::string text = sceneToml(scene);
    EXPECT_NE(text.find("[[camera.key]]\nposition = [3, 2, 1]\ntarget = [0, 1, 0]\nfov_y = 0.5\nseconds = 4\n"),
              text.npos)
        << text;
    EXPECT_EQ(sceneToml(sceneOf(text, "a.toml")), text);
    const Scene far = sceneOf("origin = [1000, 0, 0]\n[[camera.key]]\nposition = [1001, 2, 3]\n", "a.toml");
    EXPECT_EQ(far.camera_keys[0].position, glm::vec3(1, 2, 3));
    EXPECT_NE(sceneToml(far).find("position = [1001, 2, 3]"), std::string::npos);
}

TEST(CameraKeys, StandInAFileOfTheirOwnToo) {
    const auto folder = test::written("").parent_path();
    std::ofstream(folder / "alone.toml") << "[[key]]\nposition = [1, 2, 3]\n[[key]]\nseconds = 2\n";
    std::ofstream(folder / "scene.toml") << "name = 'x'\n[medium]\ncount = 5\n" << kTwo;
    std::ofstream(folder / "keys.json") << R"([{"position": [1, 2, 3]}, {"target": [0, 1, 0], "seconds": 2.5}])";
    EXPECT_EQ(loadCameraKeys(folder / "alone.toml").size(), 2u);
    EXPECT_EQ(loadCameraKeys(folder / "scene.toml")[1].seconds, 4);
    const auto keys = loadCameraKeys(folder / "keys.json");
    EXPECT_EQ(keys[0].position, glm::vec3(1, 2, 3));
    EXPECT_EQ(keys[1].seconds, 2.5f);
}

TEST(CameraKeys, ThatAreWrongAreToldInOneLineWithTheirNumber) {
    EXPECT_EQ(problemOf(kTwo), "");
    const auto expect = [](const std::string& text, const char* what, const std::string& name = "keys.toml") {
        const std::string problem = problemOf(text, name);
        EXPECT_NE(problem.find(what), problem.npos) << problem;
        EXPECT_EQ(problem.find('\n'), problem.npos) << problem;
    };
    expect("", "no key views");
    expect("[camera]\nfov_y = 1\n", "no key views");
    expect(kTwo + "[[camera.key]]\nseconds = 0\n", "camera.key[2].seconds: 0 is not allowed here");
    expect(kTwo + "[[camera.key]]\nposition = [0, 0, 0]\n", "camera.key[2].target: is where the camera stands");
    expect(kTwo + "[[camera.key]]\nspeed = 1\n", "camera.key[2].speed: unknown key");
    expect("[[key]]\nseconds = 1\n", "key[0].seconds: no key is before the first one");
    std::string many;
    for (int i = 0; i < 65; ++i) many += "[[key]]\n";
    expect(many, "from 0 to 64 of them");
    expect("{}", "no JSON array", "keys.json");
    expect("[1, 2]", "no JSON array", "keys.json");
    expect("[{\"position\": [1, 2]}]", "key[0].position", "keys.json");
    expect("[{\"position\": " + std::string(100'000, '[') + std::string(100'000, ']') + "}]", "key[0].position",
           "keys.json");
}

} // namespace
} // namespace brume::camera_keys_test
