// Far from the camera, far from zero, and in the right order.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "tests/hard/hard.h"

namespace brume::test::place_test {
namespace {

constexpr uint32_t kWidth = 48, kHeight = 36;

// Naive: intersects with |c|^2 - (c.w)^2, which at 2 km errs by metres; or keeps depth in 16 bits.
TEST_F(HardTest, FromTwoKilometres) {
    const Point point = thick({0, 0, 0}, 30, 3, kInside);
    const double k = std::sqrt(50.0) / 9;
    for (const glm::vec3 from : {glm::vec3(0, 0, 2000), glm::vec3(1200, 900, -1323)}) {
        const Pose pose = lookAt(from, {0, 0, 0}, 0.012f);
        for (const Way& way : waysAndSampled()) {
            const Seen seen = transmittance(plain(), sceneOf({point}, kInside), way, pose, kWidth, kHeight);
            judge("camera 2 km away: transmittance", way, seen.error, allowed(2000, k, 3));
            EXPECT_LT(seen.lowest, 0.1);
        }
    }
}

// Of two opaque particles the nearer one is seen, from either side and at any distance. Naive: the seed sorts 10000 -
// d^2 as an unsigned number, which turns around at 100 m.
TEST_F(HardTest, TheNearerOneHidesTheFarther) {
    const float scale = 6, falloff = 1.6f;
    for (const float distance : {20.0f, 99.0f, 101.0f, 150.0f, 2000.0f})
        for (const Way& way : waysAndSampled()) {
            Point red = thick({0, 0, 6}, scale, 30, falloff), green = thick({0, 0, -6}, scale, 30, falloff);
            red.albedo = {1, 0, 0};
            green.albedo = {0, 1, 0};
            for (const bool red_first : {false, true}) { // in memory
                Scene scene = sceneOf(red_first ? std::vector{red, green} : std::vector{green, red}, falloff);
                scene.lights[0].to_light = {0, 1, 0};
                scene.render.shadow_size = 64;
                choose(scene, way);
                for (const float side : {1.0f, -1.0f}) {
                    const Pose pose = lookAt({0, 0, side * distance}, {0, 0, 0}, 4 / distance);
                    const glm::vec4 seen = plain().see(scene, pose, 9, 9).at(4, 4);
                    const double near = double(side > 0 ? seen.r : seen.g), far = double(side > 0 ? seen.g : seen.r);
                    EXPECT_GT(near, 0) << way.name() << ' ' << distance;
                    // e^-30 of the farther one's light comes through, and the cut tetrahedron's 1e-9.
                    judge("order at 20 ... 2000 m: light of the hidden particle, of the nearer one's", way, far / near,
                          1e-6);
                }
            }
        }
}

// The same particles, camera and objects in a scene file of their own, all places moved by `offset`.
Scene written(const std::string& name, const std::vector<Point>& points, glm::dvec3 offset) {
    const auto folder = std::filesystem::path(testing::TempDir());
    const auto place = [&](glm::dvec3 p) {
        std::ostringstream text;
        text.precision(17);
        text << p.x + offset.x << ", " << p.y + offset.y << ", " << p.z + offset.z;
        return text.str();
    };
    std::ofstream ply(folder / (name + ".ply"));
    ply << "ply\nformat ascii 1.0\nelement vertex " << points.size()
        << "\nproperty double x\nproperty double y\nproperty double z\nproperty float scale\nproperty float "
           "sigma_t\nend_header\n";
    for (const Point& p : points) {
        std::string line = place(p.centre);
        std::replace(line.begin(), line.end(), ',', ' ');
        ply << line << ' ' << p.scale << ' ' << p.sigma_t << '\n';
    }
    std::ofstream(folder / (name + ".toml"))
        << (offset == glm::dvec3(0) ? "" : "origin = [" + place({0, 0, 0}) + "]\n")
        << "[medium]\nlayout = \"file\"\nfile = \"" << name << ".ply\"\n[[box]]\ncentre = [" << place({1, -2, 0.5})
        << "]\n[[sphere]]\ncentre = [" << place({-2, 3, 0}) << "]\nradius = 0.5\n[camera]\nposition = ["
        << place({1, 2, 11}) << "]\ntarget = [" << place({0, 0.5, 0}) << "]\n[render]\nshadow_size = 64\n";
    return loadScene(folder / (name + ".toml"));
}

// Naive: float32 a million metres from zero has steps of 6 cm, and the picture crumbles.
TEST_F(HardTest, AWorldAMillionMetresAway) {
    std::vector<Point> points = randomPoints(200, 8, 2, 0.7f);
    for (Point& p : points)
        p.centre = glm::round(p.centre * 1024.0f) / 1024.0f; // so that the doubles of the far file are exact
    Scene here = written("here", points, {0, 0, 0}), there = written("there", points, {1e6, -1e6, 1e6});
    Stage stage_here(device(), here, 200), stage_there(device(), there, 200);
    const auto pose = [](const Scene& scene) {
        return lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y);
    };
    for (const Way& way : waysAndSampled()) {
        choose(here, way);
        choose(there, way);
        const Picture near = stage_here.see(here, pose(here), kWidth, kHeight);
        judge("world at 10^6 m with its origin: pixels that are not the bits of the one at 0", way,
              differing(near, stage_there.see(there, pose(there), kWidth, kHeight)), 0);
        float lowest = 1;
        for (const glm::vec4& pixel : near.pixels) lowest = std::min(lowest, pixel.a);
        EXPECT_LT(lowest, 0.5f);
    }
    std::ofstream(std::filesystem::path(testing::TempDir()) / "far.toml") << "[camera]\nposition = [1e6, 0, 0]\n";
    try {
        loadScene(std::filesystem::path(testing::TempDir()) / "far.toml");
        FAIL() << "a place beyond 50 km without an origin was taken";
    } catch (const SceneError& error) {
        EXPECT_NE(std::string(error.what()).find("origin"), std::string::npos) << error.what();
    }
}

} // namespace
} // namespace brume::test::place_test
