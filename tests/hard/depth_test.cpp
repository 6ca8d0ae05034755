// Optical depths from nothing to 10^4, light depths up to 200, radiance up to 10^6.
#include <algorithm>
#include <cmath>

#include "tests/hard/hard.h"

namespace brume::test::depth_test {
namespace {

constexpr uint32_t kWidth = 33, kHeight = 25; // odd: one pixel looks straight ahead

// Naive: divides by the extinction or by the depth, and gets NaN; or draws what is clear, and rounds what is behind it.
TEST_F(HardTest, ZeroExtinctionLeavesTheBackground) {
    Scene empty = sceneOf({Point{}});
    empty.medium.layout = Layout::emitter; // whose first particle is yet to be born
    empty.medium.emitter.rate = 1e-3f;
    empty.medium.emitter.life = 0.1f;
    empty.sky = {{0.1f, 0.2f, 0.7f}, {0.6f, 0.5f, 0.4f}, glm::vec3(0.3f)};
    empty.planes = {{-2, {0.5f, 0.4f, 0.3f}}};
    empty.boxes = {{{1, -1, -1}, {1, 1, 1}, 0.4f, {0.7f, 0.2f, 0.2f}}};
    empty.render.shadow_size = 32;
    Stage stage(device(), empty, 100);
    const Pose pose = lookAt({0, 0.5f, 4}, {0, 0, 0}, 1);
    ASSERT_EQ(Simulation(empty).liveCount(), 0u);
    const Picture background = stage.see(empty, pose, kWidth, kHeight);
    for (const Way& way : waysAndSampled())
        for (const float sigma_t : {0.0f, 1e-30f})
            for (const float cutoff : {1e-6f, 0.0f}) {
                Scene scene = sceneOf(randomPoints(100, 4, 2, sigma_t), 1.6f);
                scene.sky = empty.sky;
                scene.planes = empty.planes;
                scene.boxes = empty.boxes;
                scene.render.shadow_size = 32;
                scene.render.cutoff = cutoff;
                choose(scene, way);
                judge("zero extinction: pixels that are not the background's bits", way,
                      differing(stage.see(scene, pose, kWidth, kHeight), background), 0);
            }
}

// Naive: blends into 8 or 16 bits, where a layer of 1e-4 rounds to nothing and the picture stays clear; or drops
// particles below a fixed depth (the seed: 1e-3), which here is all of them.
TEST_F(HardTest, TenThousandThinLayers) {
    constexpr int kLayers = 10000;
    static_assert(kRadianceFormat == VK_FORMAT_R32G32B32A32_SFLOAT, "16-bit targets lose these layers");
    // Each layer rounds 1 - its opacity (2^-25) and the product (2^-24); equal layers round alike, so the errors add
    // up.
    const double rounding = kLayers * 1.5 / double(1 << 24);
    const Pose pose = lookAt({0, 0, 3}, {0, 0, 0}, 0.02f);
    for (const double depth : {1e-4, 1e-3}) {
        std::vector<Point> layers;
        for (int i = 0; i < kLayers; ++i) layers.push_back(thick({0, 0, -0.001f * float(i)}, 1, depth, kInside));
        Scene scene = sceneOf(layers, kInside);
        scene.lights[0].irradiance = glm::vec3(0);
        scene.sky = {glm::vec3(1), glm::vec3(1), glm::vec3(1)}; // albedo 1 under light from everywhere: a furnace
        scene.render.shadow_size = 16;
        scene.render.shadow_slices = 2;
        Stage stage(device(), scene, kLayers);
        const auto blobs = blobsOf(scene);
        const double places = allowed(13, blobs[0].k, kLayers * depth);
        for (const Way& way : waysAndSampled()) {
            choose(scene, way);
            double error = 0, furnace = 0, middle = 0;
            forPixels(stage.see(scene, pose, 5, 3), pose, [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
                double exact = 0;
                for (const auto& blob : blobs) exact += depthOn(blob, ray, supportOf(way, blob, ray));
                error = worse(error, std::abs(got.a / std::exp(-exact) - 1));
                for (int c = 0; c < 3; ++c) furnace = worse(furnace, std::abs(got[c] - 1));
                if (x == 2 && y == 1) middle = got.a;
            });
            const std::string name = "10^4 layers of depth " + std::string(depth < 5e-4 ? "1e-4" : "1e-3");
            judge(name + ": transmittance, relative", way, error, rounding + places);
            judge(name + ": furnace", way, furnace, rounding); // half an ulp of 1 for each sum and each product
            EXPECT_NEAR(middle, std::exp(-kLayers * depth),
                        (isSampled(way) ? barOf(name + ": transmittance", way).most : rounding + places) * middle)
                << way.name(); // 0.368 and e^-10
        }
    }
}

// Naive: exp(+depth) overflows, 0 * inf is NaN; Simpson's rule meets the thin lit rim with one node and makes light of
// nothing.
TEST_F(HardTest, OneParticleAsThickAsAWall) {
    const Pose pose = lookAt({0, 0, 70}, {0, 0, 0}, 0.15f);
    for (const double depth : {20.0, 200.0, 1e4})
        for (const float falloff : {kInside, 1.6f})
            for (const glm::vec3 to_light : {glm::vec3(0, 0, 1), glm::vec3(0, 0, -1), glm::vec3(0.3f, 0.8f, 0.5f)}) {
                Scene scene = sceneOf({thick({0, 0, 0}, 6 / falloff, depth, falloff)}, falloff);
                scene.lights[0].to_light = glm::normalize(to_light);
                scene.lights[0].irradiance = glm::vec3(float(4 * kPi));
                const reference::Blob blob = blobsOf(scene)[0];
                for (const Way& way : waysAndSampled()) {
                    choose(scene, way);
                    double error = 0, created = 0;
                    const Picture picture = plain().see(scene, pose, kWidth, kHeight);
                    forPixels(picture, pose, [&](glm::dvec4 got, const Ray& ray, uint32_t, uint32_t) {
                        error =
                            worse(error, std::abs(got.a - std::exp(-depthOn(blob, ray, supportOf(way, blob, ray)))));
                        // Albedo 1 and irradiance 1 / p: more than 1 - T would be light out of nothing.
                        created = worse(created, std::max(got.r - (1 - got.a), -got.r));
                    });
                    // T changes by T tau 2k (k b) a metre: at most 0.37 * 2k * 3.1, for k b where tau is 1. Places err
                    // by 1.4e-5 m.
                    if (falloff == kInside) // silhouettes of cut ones are another test's
                        judge("depth 20 ... 10^4 in one particle: transmittance", way, error,
                              3e-6 + 1.4e-5 * 0.37 * 6.2 * blob.k);
                    judge("depth 20 ... 10^4 in one particle: light out of nothing", way, created,
                          1e-6); // roundings of 1
                }
            }
}

// Light from beyond the particle: what it loses on the way in, the view loses on the way out, and T_L T_V is the same
// everywhere. Naive: the printed form divides by t + tau1 - tau0, which is 0.
TEST_F(HardTest, LightDepthThatCancelsViewDepth) {
    const Pose pose = lookAt({0, 0, 7}, {0, 0, 0}, 0.15f);
    for (const double depth : {1e-3, 0.5, 3.0, 40.0}) {
        Scene scene = sceneOf({thick({0, 0, 0}, 2, depth, kInside)}, kInside);
        scene.lights[0].to_light = {0, 0, -1};
        scene.lights[0].irradiance = glm::vec3(float(4 * kPi));
        scene.render.shadow_slices = 128;
        const auto blobs = blobsOf(scene);
        const reference::LightField field(blobs, {0, 0, -1});
        for (const Way& way : waysAndSampled()) {
            choose(scene, way);
            double error = 0;
            forPixels(plain().see(scene, pose, kWidth, kHeight), pose,
                      [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
                          if (depthOn(blobs[0], ray, wholeRay(ray)) < 1e-2 * depth) return;
                          const double rule =
                              scatteredBy(way, blobs[0], ray, [&](glm::dvec3 at) { return field.depth(at); });
                          // Simpson's nodes move with the interval's ends.
                          const double elsewhere =
                              drawnElsewhere(way, blobs[0], pose, kWidth, kHeight, x, y, [&](Interval inside) {
                                  return scatteredBy(way, blobs[0], ray, inside,
                                                     [&](glm::dvec3 at) { return field.depth(at); });
                              });
                          error = worse(error, std::abs(got.r / rule - 1) - elsewhere / rule);
                          if (x == kWidth / 2 && y == kHeight / 2 && way.quadrature == "analytic") {
                              EXPECT_NEAR(rule, depth * std::exp(-depth),
                                          (1e-6 + 1e-7 * depth) * rule); // exact for this rule, depth in float
                          }
                      });
            // Shadow texels of 1/30 of 1/k and planes of 1/15: h^2/8 of second derivatives of at most 2 k^2 tau in two
            // directions and 0.49 k^2 tau along the light. An error of the depth is one of the radiance, relatively.
            const double volume = depth * (4 / (30.0 * 30) + 0.49 / (15.0 * 15)) / 8;
            judge("light depth cancels view depth " + std::to_string(depth).substr(0, 5) + ": radiance, relative", way,
                  error, ruleError(way) + volume + 1e-4 + 2 * allowed(7, blobs[0].k, depth));
        }
    }
}

// Naive: e^-200 is 0 in float, and a logarithm or a ratio of it is not a number; half floats end at a depth of 17.
TEST_F(HardTest, LightDepth200) {
    const Point lit = thick({0, 0, 0}, 1, 1, kInside);
    Scene open = sceneOf({lit}, kInside), hidden = sceneOf({thick({0, 20, 0}, 60, 200, kInside), lit}, kInside);
    hidden.lights[0].to_light = open.lights[0].to_light = {0, 1, 0};
    const Pose pose = lookAt({0, 0, 5}, {0, 0, 0}, 0.1f);
    for (const Way& way : waysAndSampled()) {
        choose(open, way);
        choose(hidden, way);
        double brightest = 0, leaked = 0;
        for (const glm::vec4& pixel : plain().see(open, pose, kWidth, kHeight).pixels)
            brightest = std::max(brightest, double(pixel.r));
        for (const glm::vec4& pixel : plain().see(hidden, pose, kWidth, kHeight).pixels)
            leaked = worse(leaked, std::abs(double(pixel.r)));
        EXPECT_GT(brightest, 0.02) << way.name();
        // The blocker is so wide (1/k = 2.5 m) that over the whole lit particle, 0.8 m from its axis, its depth is
        // above 180.
        judge("light depth 200: light that leaks, of the open brightness", way, leaked / brightest, std::exp(-180.0));
    }
}

// Naive: 16-bit radiance ends at 65504, and a fixed point far below. Factors of two are exact in floating point: scaled
// light must give scaled bits.
TEST_F(HardTest, RadianceOfAMillion) {
    const float million = 1 << 20;
    Scene dim = sceneOf(randomPoints(60, 6, 2, 0.8f), 1.6f);
    dim.sky = {{0.5f, 0.25f, 1}, {1, 0.5f, 0.25f}, glm::vec3(0.125f)};
    Scene bright = dim;
    bright.lights[0].irradiance *= million;
    for (glm::vec3* radiance : {&bright.sky.zenith, &bright.sky.horizon, &bright.sky.ambient}) *radiance *= million;
    Stage dim_stage(device(), dim, 60);
    Renderer renderer(device(), bright, 60);
    renderer.keepRadiance(true);
    Submission submission(device(), "bright");
    const EyeRequest eye{lookAt({0, 1, 9}, {0, 0, 0}, 0.8f), kWidth, kHeight};
    for (const Way& way : waysAndSampled()) {
        choose(dim, way);
        choose(bright, way);
        const Picture one = dim_stage.see(dim, eye.pose, kWidth, kHeight);
        submitAndWait(renderer, submission, Simulation(bright), {&eye, 1});
        Picture scaled{kWidth, kHeight, renderer.readRadiance()};
        double brightest = 0;
        for (glm::vec4& pixel : scaled.pixels) {
            brightest = std::max(brightest, double(pixel.r));
            pixel = {glm::vec3(pixel) / million, pixel.a};
        }
        EXPECT_GT(brightest, 5e5);
        judge("radiance 10^6: pixels that are not 2^20 times those at 1", way, differing(one, scaled), 0);
        const PictureView picture = submission.pictures()[0];
        for (uint32_t x = 0; x < kWidth; ++x) ASSERT_GE(picture.bytes[x], 250) << way.name() << ": not white";
    }
}

} // namespace
} // namespace brume::test::depth_test
