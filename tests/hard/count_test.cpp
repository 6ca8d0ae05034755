// How many particles there are, and numbers that are none.
#include <algorithm>
#include <cmath>
#include <limits>

#include "server/sim/layout.h"
#include "tests/hard/hard.h"
#include "tests/layer.h"

namespace brume::test::count_test {
namespace {

// Naive: one NaN poisons the bounds of the shadow volume, the sort, and through them every pixel.
TEST_F(HardTest, PlacesThatAreNotNumbers) {
    constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
    std::vector<Point> good = randomPoints(60, 6, 2, 0.8f);
    good[7].centre = {-0.0f, -0.0f, -0.0f}; // -0 is a place like any other
    std::vector<Point> all = good;
    const glm::vec3 bad[] = {{kNan, 0, 0}, {0, -kNan, 0}, {0, 0, kInf}, {-kInf, 1, 2}, {kNan, kNan, kNan}};
    for (size_t i = 0; i < std::size(bad); ++i) {
        Point point = good[i];
        point.centre = bad[i];
        all.insert(all.begin() + std::ptrdiff_t(12 * i), point);
    }
    Scene with = sceneOf(all, 1.6f), without = sceneOf(good, 1.6f), zero = without;
    good[7].centre = glm::vec3(0);
    zero = sceneOf(good, 1.6f);
    const auto cloud = place(with.medium, with.origin).cloud;
    ASSERT_TRUE(cloud);
    EXPECT_EQ(cloud->dropped, std::size(bad));
    const Pose pose = lookAt({0, 1, 9}, {0, 0, 0}, 0.8f);
    for (const Way& way : waysAndSampled()) {
        for (Scene* scene : {&with, &without, &zero}) choose(*scene, way);
        const Picture clean = plain().see(without, pose, 48, 36);
        const Picture rest = plain().see(with, pose, 48, 36);
        judge("NaN and infinite places in a PLY: pixels that differ from those without", way, differing(clean, rest),
              0);
        judge("place -0 in a PLY: pixels that differ from those of 0", way,
              differing(clean, plain().see(zero, pose, 48, 36)), 0);
        double finite = 0;
        for (const glm::vec4& pixel : rest.pixels)
            finite = worse(finite, double(0 * (pixel.r + pixel.g + pixel.b + pixel.a)));
        EXPECT_EQ(finite, 0) << way.name();
    }
}

TEST_F(HardTest, NoParticleAtAll) {
    Scene scene = sceneOf({Point{}});
    scene.medium.layout = Layout::emitter;
    scene.medium.emitter.rate = 1e-3f;
    scene.medium.emitter.life = 0.1f;
    scene.sky.zenith = scene.sky.horizon = glm::vec3(0.25f);
    Stage stage(device(), scene, Simulation(scene).capacity());
    for (const Way& way : waysAndSampled()) {
        choose(scene, way);
        ASSERT_EQ(Simulation(scene).liveCount(), 0u);
        double error = 0;
        for (const glm::vec4& pixel : stage.see(scene, Pose{}, 20, 10).pixels)
            for (int c = 0; c < 4; ++c) error = worse(error, std::abs(double(pixel[c]) - (c < 3 ? 0.25 : 1.0)));
        judge("no particle: the sky", way, error, 1e-6); // blended between two equal colours
    }
}

// The first, the last but one and the last particle by themselves, all others faint in a heap beside them: each must be
// where it was put, and no part of the heap lost. Naive: 16-bit indices, a grid of one dimension, a group count of
// 65536.
class CountTest : public HardTest {
protected:
    static constexpr uint32_t kSide = 32;

    static void check(uint32_t count) {
        constexpr float kPixel = 0.25f;                   // m, at the origin
        const double heap = 4;                            // its optical depth
        const auto atPixel = [](uint32_t x, uint32_t y) { // the middle of one
            return glm::vec3(kPixel * (float(x) + 0.5f - 16), -kPixel * (float(y) + 0.5f - 16), 0);
        };
        const glm::uvec2 first(8, 8), last(24, 24), last_but_one(24, 8), rest(8, 24);
        std::vector<Point> points;
        Random random(count);
        for (uint32_t i = 0; i < count; ++i) {
            const uint32_t from_end = count - 1 - i;
            const glm::vec3 depth_in_heap(0, 0, random.uniform(-0.2f, 0.2f));
            if (i == 0)
                points.push_back(thick(atPixel(first.x, first.y), 3, 1, kInside));
            else if (from_end == 0)
                points.push_back(thick(atPixel(last.x, last.y), 3, 2, kInside));
            else if (from_end == 1)
                points.push_back(thick(atPixel(last_but_one.x, last_but_one.y), 3, 3, kInside));
            else
                points.push_back(
                    thick(atPixel(rest.x, rest.y) + depth_in_heap, 0.6f, heap / count, kInside)); // of a few pixels
        }
        Scene scene = sceneOf(points, kInside);
        scene.render.shadow_size = 16;
        scene.render.shadow_slices = 2;
        scene.render.grid.spacing = 0.08f;
        // Every particle is looked for; what merging changes is measured in tests/gpu/large_test.cpp.
        scene.render.merge = 0;
        Simulation simulation(scene);
        Renderer renderer(device(), scene, simulation.capacity());
        renderer.keepRadiance(true);
        Submission submission(device(), "count");
        Pose pose; // so far away that the heap lies on one ray
        pose.position = {0, 0, 100};
        pose.fov_y = 2 * std::atan(kPixel * kSide / 2 / 100);

        struct Expected {
            glm::uvec2 at;
            double transmittance, layers; // layers that can be seen there
        };
        std::vector<Expected> expected; // every way sees the whole Gaussian
        const auto blobs = blobsOf(scene);
        double darkest = 1;
        for (const glm::uvec2 place : {first, last, last_but_one, rest, glm::uvec2(16, 16)})
            for (const glm::uvec2 at : {place, place + glm::uvec2(1, 0)}) {
                const Ray ray = rayThrough(pose, kSide, kSide, at.x, at.y);
                double depth = 0, layers = 0;
                for (const auto& blob : blobs) {
                    const double one = depthOn(blob, ray, wholeRay(ray));
                    depth += one;
                    layers += one > 1e-12;
                }
                expected.push_back({at, std::exp(-depth), layers});
                darkest = std::min(darkest, std::exp(-depth));
            }
        EXPECT_LT(darkest, count == 1 ? 0.4 : 0.2);

        std::string done; // one quadrature of each method: no index depends on it
        for (const Way& way : allWays()) {
            if (way.method == done) continue;
            done = way.method;
            const std::string name = "N = " + std::to_string(count) + ": transmittance";
            if (refused(name, way, scene)) continue; // tests/gpu/grid_test.cpp counts for it
            Set wish{{"render.method", way.method}};
            if (!way.quadrature.empty())
                wish.changes.emplace_back(quadratureSetting(way.quadrature)->path, way.quadrature);
            if (way.steps > 0) wish.changes.emplace_back("render.isv.steps", way.steps);
            Command command;
            command.body = wish;
            simulation.step({&command, 1});
            const EyeRequest eye{pose, kSide, kSide};
            submitAndWait(renderer, submission, simulation, {&eye, 1});
            const Picture picture{kSide, kSide, renderer.readRadiance()};
            const double k = std::sqrt(50.0) / double(0.6f * kInside);
            // Places as seen from 100 m, tau T at most 1/e; the cut-off; and of each layer the roundings of 1 - its
            // opacity and of the product, 1.5 * 2^-24 of T.
            for (const Expected& one : expected)
                judge(name, way, std::abs(double(picture.at(one.at.x, one.at.y).a) - one.transmittance),
                      allowed(100, k, 1) + one.layers * 1.5 / double(1 << 24) * one.transmittance);
            double finite = 0;
            for (const glm::vec4& pixel : picture.pixels)
                finite = worse(finite, double(0 * (pixel.r + pixel.g + pixel.b + pixel.a)));
            EXPECT_EQ(finite, 0) << way.name();
        }
    }
};

TEST_F(CountTest, One) { check(1); }
TEST_F(CountTest, AroundSixteenBits) {
    for (const uint32_t count : {65535u, 65536u, 65537u}) check(count);
}
TEST_F(CountTest, AMillion) {
    BRUME_WHOLE_LAYER_ONLY();
    check(1'000'000);
}

} // namespace
} // namespace brume::test::count_test
