// Random scenes: equal on all machines, over the ranges that they promise, and loadable.
#include "tools/random_scene/random_scene.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include <gtest/gtest.h>

#include "common/scene_text.h"
#include "server/sim/simulation.h"
#include "tools/random_scene/random_cameras.h"
#include "tools/random_scene/random_layout.h"

namespace brume {
namespace {

std::filesystem::path folder() { return std::filesystem::path(testing::TempDir()) / "brume-random-scene"; }

std::string bytesOf(const std::filesystem::path& file) {
    std::ostringstream all;
    all << std::ifstream(file, std::ios::binary).rdbuf();
    return all.str();
}

// All that is written of a scene, as one number.
uint64_t hashOf(const RandomScene& random) {
    std::filesystem::path file = save(random, folder());
    std::string bytes = bytesOf(file);
    bytes += bytesOf(file.replace_extension(".ply"));
    uint64_t hash = 0;
    for (const char byte : bytes) hash = mix64(hash + uint8_t(byte) + 1);
    return hash;
}

TEST(RandomScene, OneSeedIsOneSceneOnAllMachines) {
    EXPECT_EQ(hashOf(randomScene(7)), hashOf(randomScene(7)));
    EXPECT_NE(hashOf(randomScene(7)), hashOf(randomScene(8)));
    // Written down once. Whoever changes what is drawn changes all measured numbers, and says so.
    EXPECT_EQ(hashOf(randomScene(1)), 111035736804915302u);
    EXPECT_EQ(hashOf(randomScene(12)), 9869892175150951151u);
    EXPECT_EQ(hashOf(randomScene(1, RandomKind::lit)), 5632757605867036181u);
    EXPECT_EQ(hashOf(randomScene(12, RandomKind::lit)), 17916982376064681256u);
}

TEST(RandomScene, LoadsAsItWasDrawn) {
    for (uint64_t seed = 0; seed < 60; ++seed) {
        const RandomScene random = randomScene(seed);
        const Scene scene = loadScene(save(random, folder()));
        const Simulation simulation(scene);
        ASSERT_EQ(simulation.liveCount(), random.points.position.size()) << seed;
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        for (size_t i = 0; i < particles.size(); i += 97) {
            EXPECT_EQ(particles[i].centre, random.points.position[i]) << seed;
            EXPECT_EQ(particles[i].scale, random.points.scale[i]) << seed;
            EXPECT_EQ(particles[i].sigma_t, random.points.sigma_t[i]) << seed;
        }
        EXPECT_EQ(scene.boxes.size(), random.scene.boxes.size());
        EXPECT_EQ(scene.camera.position, random.scene.camera.position);
        EXPECT_EQ(scene.medium.asymmetry, random.scene.medium.asymmetry);
        EXPECT_NEAR(glm::dot(scene.lights.front().to_light, random.scene.lights.front().to_light), 1, 1e-6);
    }
}

TEST(RandomScene, CoversItsRanges) {
    std::map<std::string, int> layouts, cameras;
    std::set<std::string> objects;
    constexpr int kScenes = 600;
    int with_objects = 0, lobes = 0, thin = 0, dense = 0, few = 0, many = 0, small = 0, large = 0;
    for (uint64_t seed = 0; seed < kScenes; ++seed) {
        const RandomScene random = randomScene(seed);
        ++layouts[random.layout], ++cameras[random.camera];
        const Scene& scene = random.scene;
        if (!scene.boxes.empty()) objects.insert("box");
        if (!scene.spheres.empty()) objects.insert("sphere");
        if (!scene.planes.empty()) objects.insert("plane");
        with_objects += !scene.boxes.empty() || !scene.spheres.empty() || !scene.planes.empty();
        lobes += scene.medium.anisotropy > 0;
        const size_t count = random.points.position.size();
        if (!scene.planes.empty()) { // else all is dark, or nothing is seen
            EXPECT_GE(scene.lights.front().to_light.y, 0) << seed;
            EXPECT_GT(scene.camera.position.y, scene.planes.front().height) << seed;
        }
        ASSERT_TRUE(count >= 1 && count <= 20'000) << seed;
        ASSERT_TRUE(random.depth >= 0.01f && random.depth <= 100) << seed;
        ASSERT_TRUE(random.size.x >= 160 && random.size.x <= 1920 && random.size.y >= 90 && random.size.y <= 1080);
        thin += random.depth<0.1f, dense += random.depth> 10;
        few += count<12, many += count> 1700;
        small += random.size.x<260, large += random.size.x> 1200;
        const auto [lo, hi] = std::ranges::minmax(random.points.scale);
        EXPECT_LE(hi / lo, 31 / 0.3) << seed; // the layouts' own sizes besides
    }
    for (const char* layout : randomLayouts()) EXPECT_GT(layouts[layout], kScenes / 14) << layout;
    for (const char* camera : randomCameras()) EXPECT_GT(cameras[camera], kScenes / 8) << camera;
    EXPECT_EQ(objects, (std::set<std::string>{"box", "plane", "sphere"}));
    EXPECT_NEAR(with_objects, kScenes / 3, kScenes / 12);
    EXPECT_NEAR(lobes, kScenes * 2 / 3, kScenes / 12);
    for (const int part : {thin, dense, few, many, small, large}) EXPECT_GT(part, kScenes / 10);
}

// Scenes of kind `lit`: what the others have, smaller, and fogs, points, spots and more bodies.
TEST(RandomScene, LitOnesLoadAsTheyWereDrawn) {
    EXPECT_EQ(hashOf(randomScene(7, RandomKind::lit)), hashOf(randomScene(7, RandomKind::lit)));
    EXPECT_NE(randomScene(7, RandomKind::lit).scene.name, randomScene(7).scene.name); // neither file replaces the other
    for (uint64_t seed = 0; seed < 60; ++seed) {
        const RandomScene random = randomScene(seed, RandomKind::lit);
        const Scene scene = loadScene(save(random, folder()));
        const SceneLists lists = Simulation(scene).now().lists;
        ASSERT_EQ(lists.lights.size(), localLightsOf(random.scene).size()) << seed;
        ASSERT_EQ(lists.fogs.size(), random.scene.fogs.size()) << seed;
        ASSERT_EQ(scene.boxes.size() + scene.spheres.size(), random.scene.boxes.size() + random.scene.spheres.size());
        for (size_t i = 0; i < lists.lights.size(); ++i) {
            const Light &loaded = lists.lights[i], &drawn = random.scene.lights[i + 1]; // the sun is the first
            EXPECT_EQ(loaded.type, drawn.type) << seed;
            EXPECT_EQ(loaded.position, drawn.position) << seed;
            EXPECT_EQ(loaded.intensity, drawn.intensity) << seed;
            EXPECT_EQ(loaded.range, drawn.range) << seed;
            EXPECT_EQ(loaded.shadows, drawn.shadows) << seed;
            EXPECT_NEAR(glm::dot(loaded.axis, drawn.axis), 1, 1e-6) << seed;
        }
        for (size_t i = 0; i < lists.fogs.size(); ++i) {
            EXPECT_EQ(lists.fogs[i].extinction, random.scene.fogs[i].extinction) << seed;
            EXPECT_EQ(lists.fogs[i].lo, random.scene.fogs[i].lo) << seed;
            EXPECT_EQ(lists.fogs[i].radius, random.scene.fogs[i].radius) << seed;
        }
    }
}

TEST(RandomScene, LitOnesCoverTheirRanges) {
    constexpr int kScenes = 300;
    std::map<size_t, int> fogs, lights;
    int points = 0, spots = 0, endless = 0, unshadowed = 0, balls = 0, layers = 0, thinning = 0, bodies = 0;
    for (uint64_t seed = 0; seed < kScenes; ++seed) {
        const RandomScene random = randomScene(seed, RandomKind::lit);
        ASSERT_TRUE(random.points.position.size() <= 2000 && random.size.x <= 480) << seed;
        ++fogs[random.scene.fogs.size()], ++lights[localLightsOf(random.scene).size()];
        bodies += !random.scene.boxes.empty() || !random.scene.spheres.empty();
        for (const Fog& fog : random.scene.fogs)
            balls += fog.radius > 0, layers += fog.falloff == 0 && fog.hi<1e4f, thinning += fog.falloff> 0;
        for (const Light& light : localLightsOf(random.scene)) {
            (light.type == kPoint ? points : spots) += 1;
            endless += light.range == 0, unshadowed += !light.shadows;
            EXPECT_GT(light.radius, 0) << seed;
        }
    }
    EXPECT_EQ(fogs.size(), 3u);
    EXPECT_EQ(lights.size(), 7u);
    for (const auto& [count, scenes] : fogs) EXPECT_GT(scenes, kScenes / 6) << count;
    for (const auto& [count, scenes] : lights) EXPECT_GT(scenes, kScenes / 14) << count;
    EXPECT_NEAR(bodies, kScenes * 2 / 3, kScenes / 8);
    for (const int part : {points, spots, endless, unshadowed}) EXPECT_GT(part, kScenes / 2);
    for (const int part : {balls, layers, thinning}) EXPECT_GT(part, kScenes / 8);
}

// The depth that was drawn is that of the written points, by an exact sum.
TEST(RandomScene, HasTheOpticalDepthThatWasDrawn) {
    for (uint64_t seed = 0; seed < 40; ++seed) {
        const RandomScene random = randomScene(seed);
        const PointCloud& points = random.points;
        if (std::ranges::max(points.sigma_t) >= 1e4f) continue; // ended by the limit of an extinction
        const size_t stride = (points.position.size() + 31) / 32;
        double sum = 0, lines = 0;
        for (size_t i = 0; i < points.position.size(); i += stride)
            for (int axis = 0; axis < 3; ++axis, ++lines)
                for (size_t j = 0; j < points.position.size(); ++j) {
                    glm::dvec3 off = points.position[j] - points.position[i];
                    off[axis] = 0;
                    const double s = 0.1 * double(points.scale[j]) * double(random.scene.medium.falloff);
                    sum += std::sqrt(2 * 3.141592653589793) * s * double(points.sigma_t[j]) *
                           std::exp(-0.5 * glm::dot(off, off) / (s * s));
                }
        EXPECT_NEAR(sum / lines / double(random.depth), 1, 0.02) << seed;
    }
}

TEST(RandomScene, SaysWhatCannotBeWritten) { EXPECT_THROW(save(randomScene(1), "/dev/null/scenes"), std::exception); }

} // namespace
} // namespace brume
