// The camera inside the medium: in one particle, in a thousand, moving through, the near plane cutting what it may.
#include <algorithm>
#include <cmath>
#include <string>

#include "tests/hard/hard.h"
#include "tests/layer.h"

namespace brume::test::near_test {
namespace {

constexpr uint32_t kWidth = 64, kHeight = 48;

Scene sceneNear(const std::vector<Point>& points, float falloff) {
    Scene scene = sceneOf(points, falloff);
    scene.render.shadow_size = 32; // transmittance is compared
    return scene;
}

// Float: places err by about 1e-6 m, ten times that where a ray grazes a face, and extinctions reach 4/m here.
constexpr double kFloat = 5e-5;

// Naive: the proxy's front lies behind the camera and is clipped away, and the particle vanishes when entered.
TEST_F(HardTest, InsideOneParticle) {
    for (const float falloff : {1.6f, 8.0f}) {
        const Point point{{1, -2, 3}, 1.5f, 1};
        for (const glm::vec3 from : {glm::vec3(0), glm::vec3(0.2f, 0.1f, 0), glm::vec3(0, 0, 0.4f),
                                     glm::vec3(-0.2f, 0.1f, 0.3f), glm::vec3(0, 0.28f, 0)})
            for (const glm::vec3 direction : {glm::vec3(0, 0, -1), glm::vec3(1, 1, 0), glm::vec3(-1, 0.3f, 1)})
                for (const float fov : {0.3f, 1.2f, 2.6f}) {
                    const glm::vec3 eye = point.centre + from;
                    for (const Way& way : waysAndSampled()) {
                        const Seen seen = transmittance(plain(), sceneNear({point}, falloff), way,
                                                        lookAt(eye, eye + direction, fov), 24, 18);
                        judge("camera inside one particle: transmittance", way, seen.error, kFloat);
                        EXPECT_GT(seen.covered, 300) << way.name();
                    }
                }
    }
}

// Naive: proxies of which the near plane leaves only the back are drawn twice or not at all, a thousand times over.
TEST_F(HardTest, InsideAThousandParticles) {
    std::vector<Point> points = randomPoints(1000, 1, 8, 1.2e-3f); // of inradius 1.3 to 4, all around the eye
    const Scene scene = sceneNear(points, 1.6f);
    Stage stage(device(), scene, 1000);
    for (const Way& way : waysAndSampled())
        for (const glm::vec3 direction : {glm::vec3(0, 0, -1), glm::vec3(1, 0.5f, 0.2f)}) {
            const Seen seen = transmittance(stage, scene, way, lookAt({0, 0, 0}, direction, 1.2f), 24, 18);
            EXPECT_LT(seen.lowest, 0.2);
            // A thousand roundings of 1.5 * 2^-24 of T, a thousand lengths that err by 1e-5 m at 1.2e-3/m, and the
            // cut-off.
            judge("camera inside 1,000 particles: transmittance", way, seen.error,
                  1000 * (1.5 / double(1 << 24) + 1.2e-8) + 1e-6);
        }
}

// The light of a thousand so thin that they hardly shadow each other: the sum of what each scatters by the way's rule.
TEST_F(HardTest, LightInsideAThousandThinParticles) {
    Scene scene = sceneOf(randomPoints(1000, 1, 8, 1.2e-5f), 1.6f);
    scene.lights[0].irradiance = glm::vec3(float(4 * kPi));
    Stage stage(device(), scene, 1000);
    const auto blobs = blobsOf(scene);
    double depth = 0; // of a line through all of them
    for (const reference::Blob& blob : blobs) depth += 2 * blob.half_line;
    EXPECT_LT(depth, 0.05);
    const Pose pose = lookAt({0, 0, 0}, {1, 0.5f, 0.2f}, 1.2f);
    for (const Way& way : waysAndSampled()) {
        choose(scene, way);
        double error = 0;
        forPixels(stage.see(scene, pose, 6, 4), pose, [&](glm::dvec4 got, const Ray& ray, uint32_t, uint32_t) {
            double sum = 0;
            for (const reference::Blob& blob : blobs) sum += scatteredBy(way, blob, ray, [](glm::dvec3) { return 0; });
            error = worse(error, std::abs(got.r / sum - 1));
        });
        // Light is lost to one line at most, view to half of one.
        judge("camera inside 1,000 thin particles: radiance, relative", way, error, ruleError(way) + 1.5 * depth);
    }
}

// Naive: a quadrature or a proxy that changes where the camera enters, and the picture pops.
TEST_F(HardTest, TheWayThroughAParticle) {
    const float scale = 3;
    const Point point = thick({0, 0, 0}, scale, 2, kInside);
    Scene scene = sceneNear({point}, kInside);
    const double k = std::sqrt(50.0) / double(scale * kInside), step = 0.02;
    // Optical depth changes along the ray by sigma, across it by at most sqrt(2/e) k tau.
    const double bound = step * (double(point.sigma_t) + std::sqrt(2 / std::exp(1.0)) * k * 2) + 1e-5;
    for (const Way& way : waysAndSampled()) {
        choose(scene, way);
        Picture frames[3] = {}; // the newest first
        double jump = 0, one_step = 0, two_steps = 0, brightest = 0;
        for (int i = 0; i <= 100; ++i) {
            Pose pose;
            pose.position = {0.1f, 0.05f, float(1.0 - i * step)};
            pose.fov_y = 1;
            frames[2] = std::move(frames[1]);
            frames[1] = std::move(frames[0]);
            frames[0] = plain().see(scene, pose, 16, 12);
            const auto change = [&](int back, size_t p) {
                return std::abs(double(frames[0].pixels[p].r) - double(frames[back].pixels[p].r));
            };
            for (size_t p = 0; p < frames[0].pixels.size(); ++p) {
                brightest = std::max(brightest, double(frames[0].pixels[p].r));
                if (i > 0) {
                    jump = worse(jump, std::abs(std::log(double(frames[0].pixels[p].a)) -
                                                std::log(double(frames[1].pixels[p].a))));
                    one_step = worse(one_step, change(1, p));
                }
                if (i > 1) two_steps = worse(two_steps, change(2, p));
            }
        }
        judge("moving through a particle, 2 cm a step: change of optical depth", way, jump, bound);
        // What is continuous changes half as much in half the time (more where it bends); a pop does not.
        EXPECT_GT(brightest, 0.02);
        judge("moving through a particle: change of radiance in one step, of that in two", way, one_step / two_steps,
              0.7);
    }
}

// Naive: clips triangles against the near plane and interpolates across the cut.
TEST_F(HardTest, TheNearPlaneCutsOneTwoOrThreeVertices) {
    BRUME_WHOLE_LAYER_ONLY();
    Random random(5);
    int cut[5] = {};
    for (int i = 0; i < 80; ++i) {
        const Point point{random.inCube(3), random.uniform(0.3f, 3), random.uniform(0.3f, 4)};
        const glm::vec3 from = point.centre + random.inCube(0.8f * point.scale),
                        to = point.centre + random.inCube(0.8f * point.scale);
        const Pose pose = lookAt(from, to, random.uniform(0.5f, 2));
        const int behind = verticesBehind(point, pose);
        ++cut[behind];
        for (const Way& way : ways()) {
            if (behind < 1 || behind > 3) continue;
            const Seen seen = transmittance(plain(), sceneNear({point}, i % 2 ? 1.6f : 8), way, pose, kWidth, kHeight);
            judge("near plane cuts " + std::to_string(behind) + " of 4 vertices: transmittance", way, seen.error,
                  kFloat);
        }
    }
    for (const int behind : {1, 2, 3}) EXPECT_GE(cut[behind], 3) << behind;
}

} // namespace
} // namespace brume::test::near_test
