// Particles seen edge-on, of no size, of enormous size, smaller than a pixel, and on top of each other.
#include <cmath>

#include "tests/hard/hard.h"
#include "tests/layer.h"

namespace brume::test::shape_test {
namespace {

constexpr uint32_t kWidth = 96, kHeight = 72;

Scene sceneOfShape(const std::vector<Point>& points, float falloff) {
    Scene scene = sceneOf(points, falloff);
    scene.render.shadow_size = 32; // transmittance is compared
    return scene;
}

// Float: places err by about 1e-6 m, ten times that where a ray grazes a face, and extinctions reach 4/m here.
constexpr double kFloat = 5e-5;

// From its axes of symmetry, where pixel centres fall on the edges inside the fan. Naive: drawn twice, T is squared;
// left out, 1.
TEST_F(HardTest, VertexOnEdgeEveryPixelOnce) {
    const Point point{{0, 0, 0}, 1, 1.5f};
    for (const glm::vec3 from :
         {glm::vec3(0, 0, 3), glm::vec3(3, 0, 0), glm::vec3(0, 3, 0), kVertices[0] * 3.0f, kVertices[3] * -3.0f})
        for (const Way& way : ways()) {
            const Seen seen =
                transmittance(plain(), sceneOfShape({point}, 8), way, lookAt(from, {0, 0, 0}, 0.7f), kWidth, kHeight);
            judge("vertex on an edge, every pixel once: transmittance", way, seen.error, kFloat);
            EXPECT_LT(seen.lowest, 0.4);
        }
}

// Naive: divides by the area of a triangle that has none, by the cosine of a face that is seen from the side.
TEST_F(HardTest, EdgeOn) {
    const Point point{{0, 0, 0}, 1, 2};
    const glm::vec3 along = kVertices[1] - kVertices[0]; // an edge
    const glm::vec3 face = (kVertices[0] + kVertices[1] + kVertices[2]) / 3.0f;
    const Pose poses[] = {
        lookAt(kVertices[0] - 2.0f * along, {0, 0, 0}, 0.6f),             // two vertices in one line
        lookAt(kVertices[0] - 1.01f * along, {0, 0, 0}, 0.8f),            //
        lookAt(face + 3.0f * along, face, 0.6f),                          // in the plane of a face
        lookAt(face - 1.5f * (kVertices[2] - face), {0, 0, 0}, 0.8f),     //
        lookAt(kVertices[2], {0, 0, 0}, 1),                               // at a vertex
        lookAt(face, {0, 0, 0}, 1),                                       // on a face
        lookAt(face, face + glm::vec3(0.1f, 1, 0.3f), 1),                 //
        lookAt(0.5f * (kVertices[0] + kVertices[3]), kVertices[3], 0.7f), // along an edge, on it
        lookAt({0, 3, 0}, {0, 0, 0}, 0.6f),
        lookAt({0, -3, 0}, {0, 0, 0}, 0.6f), // straight down and up
    };
    for (const Pose& pose : poses)
        for (const Way& way : ways())
            judge("edge-on, at a vertex, on a face: transmittance", way,
                  transmittance(plain(), sceneOfShape({point}, 8), way, pose, kWidth, kHeight).error, kFloat);
}

// The smallest, the thinnest and the farthest that a scene may hold. Naive: their triangles have no area in float, and
// 1 / area is not a number.
TEST_F(HardTest, ZeroVolume) {
    const struct {
        Point point;
        Pose pose;
        float falloff;
    } cases[] = {
        {{{0, 0, -4.9e4f}, 1e-3f, 1e4f}, lookAt({0, 0, 0}, {0, 0, -1}, 0.05f), 0.1f},
        {{{0, 0, -4.9e4f}, 1e-3f, 1e4f}, lookAt({0, 0, 0}, {0, 0, -1}, 0.05f), 10},
        {{{4.9e4f, -4.9e4f, 4.9e4f}, 1e-3f, 1e4f}, lookAt({-4.9e4f, 0, 0}, {4.9e4f, -4.9e4f, 4.9e4f}, 0.05f), 1.6f},
        {{{0, 0, 0}, 1e-3f, 1e-9f}, lookAt({0, 0, 3}, {0, 0, 0}, 0.6f), 1.6f}};
    for (const auto& one : cases)
        for (const Way& way : waysAndSampled()) {
            // Less than a thousandth of a pixel: nothing to see, at most where a pixel's centre happens to meet it.
            const Seen seen =
                transmittance(plain(), sceneOfShape({one.point}, one.falloff), way, one.pose, kWidth, kHeight);
            judge("particles without volume: transmittance", way, seen.error, 1e-6);
        }
}

// u -> 0: a tenth of a millimetre. u -> huge: ten kilometres, seen from within and from beside. Naive: k^2 b^2 from 1 /
// u^2 overflows or cancels; erf(a + h) - erf(a) of a wide Gaussian is 0.
TEST_F(HardTest, TheSmallestAndTheLargestWidth) {
    for (const Way& way : waysAndSampled()) {
        const Point tiny{{0, 0, 0}, 1e-3f, 1e4f}; // u = 1e-4, depth 0.25
        const Seen small = transmittance(plain(), sceneOfShape({tiny}, 0.1f), way,
                                         lookAt({0, 0, 0.1f}, {0, 0, 0}, 0.004f), kWidth, kHeight);
        judge("u = 10^-4 m: transmittance", way, small.error, allowed(0.1, 7.07e4, 0.25));
        EXPECT_LT(small.lowest, 0.8);
        const Point huge{{0, 0, 0}, 1e3f, 1e-3f}; // u = 1e4, depth 2.5 of the whole, 1.3 of the tetrahedron
        for (const Pose& pose : {lookAt({10, 20, 30}, {0, 0, 0}, 1), lookAt({0, 700, 0}, {500, 0, 0}, 1),
                                 lookAt({0, 0, 2900}, {0, 0, 0}, 0.8f)}) {
            const Seen large = transmittance(plain(), sceneOfShape({huge}, 10), way, pose, kWidth, kHeight);
            // Lengths err by 10 ulps of a kilometre where a ray grazes a face, at 1e-3/m.
            judge("u = 10^4 m: transmittance", way, large.error, allowed(3000, 7.07e-4, 2.5) + 1e-6);
            EXPECT_LT(large.lowest, 0.6);
        }
    }
}

// Particles of a tenth of a pixel. Naive: drops triangles that miss every pixel's centre on average (too clear), or
// widens them to a pixel (too dark). A pixel's centre is one sample of what the pixel shows, so the mean must be that
// of eight times as fine a picture.
TEST_F(HardTest, SmallerThanAPixel) {
    constexpr uint32_t kFine = 8;
    std::vector<Point> points;
    Random random(17);
    const float pixel = 2 * std::tan(0.25f) * 10 / 64; // m, at the distance of 10 m
    for (int i = 0; i < 20000; ++i) {
        const float radius = 0.1f * pixel; // a standard deviation is u / 10
        points.push_back(thick({random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-0.5f, 0.5f)},
                               10 * radius / kInside, double(random.uniform(0.2f, 2)), kInside));
    }
    Scene scene = sceneOfShape(points, kInside);
    Stage stage(device(), scene, uint32_t(points.size()));
    const Pose pose = lookAt({0, 0, 10}, {0, 0, 0}, 0.5f);
    for (const Way& way : ways()) {
        choose(scene, way);
        if (refused("particles of 0.1 pixel: mean opacity against 64 samples a pixel, relative", way, scene)) continue;
        const Picture coarse = stage.see(scene, pose, 64, 64), fine = stage.see(scene, pose, 64 * kFine, 64 * kFine);
        double mean = 0, sampled = 0, within = 0; // opacity; variance of one sample
        for (uint32_t y = 0; y < 64; ++y)
            for (uint32_t x = 0; x < 64; ++x) {
                double sum = 0, squares = 0;
                for (uint32_t j = 0; j < kFine * kFine; ++j) {
                    const double opacity = 1 - double(fine.at(x * kFine + j % kFine, y * kFine + j / kFine).a);
                    sum += opacity / (kFine * kFine);
                    squares += opacity * opacity / (kFine * kFine);
                }
                mean += sum / (64 * 64);
                within += (squares - sum * sum) / (64 * 64);
                sampled += (1 - double(coarse.at(x, y).a)) / (64 * 64);
            }
        EXPECT_GT(mean, 0.05);
        // Four standard deviations of the mean of that many independent samples.
        judge("particles of 0.1 pixel: mean opacity against 64 samples a pixel, relative", way,
              std::abs(sampled / mean - 1), 4 * std::sqrt(within / (64 * 64)) / mean);
    }
}

// Equal depth keys. Naive: an unstable sort or unordered blending, and the colour flickers from frame to frame.
TEST_F(HardTest, CoincidentParticlesOfTwoColours) {
    BRUME_WHOLE_LAYER_ONLY();
    std::vector<Point> points;
    for (int i = 0; i < 200; ++i) {
        Point point = thick({float(i / 2 % 5) - 2, float(i / 2 / 5 % 4) - 1.5f, 0}, 2, 1, 1.6f);
        point.albedo = i % 2 ? glm::vec3(1, 0, 0) : glm::vec3(0, 0, 1);
        points.push_back(point);
    }
    Scene scene = sceneOf(points, 1.6f);
    scene.render.shadow_size = 64;
    const Pose pose = lookAt({0.3f, 0.5f, 9}, {0, 0, 0}, 0.6f);
    for (const Way& way : waysAndSampled()) {
        choose(scene, way);
        const Picture first = plain().see(scene, pose, kWidth, kHeight);
        int different = 0;
        for (int i = 0; i < 5; ++i) different += differing(first, plain().see(scene, pose, kWidth, kHeight));
        different += differing(first, Stage(device(), sceneOf({Point{}}), 300).see(scene, pose, kWidth, kHeight));
        judge("coincident particles of two albedos: pixels that differ in 6 repeats", way, different, 0);
        EXPECT_GT(first.at(kWidth / 2, kHeight / 2).r, 1e-3f);
    }
}

} // namespace
} // namespace brume::test::shape_test
