// Method isv where it does as the dissertation prints (seed 000): the Taylor series, even extinction, shadows from 5x5
// texels, the term for multiple scattering, and the early return.
#include <algorithm>
#include <cmath>
#include <functional>

#include "server/effects/object_shadow/opaque_shadow.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/light_passes.h"
#include "tests/gpu/quadrature.h"

namespace brume::test::isv_printed_test {
namespace {

constexpr uint32_t kWidth = 96, kHeight = 72;
constexpr double kTail = 5e-5; // error of a transmittance in float, as in isv_test

Scene isvScene(const std::vector<Point>& points, const char* quadrature = "transmittance") {
    Scene scene = sceneOf(points, 1.6f);
    scene.render.method = "isv";
    scene.render.shadow_size = 256;
    scene.render.shadow_slices = 128;
    setQuadrature(scene.render, quadrature);
    return scene;
}

// Rays through every third pixel that are at least 5 cm inside the tetrahedron: silhouettes are another test's.
void forRays(const Picture& picture, const Pose& pose, const reference::Blob& blob,
             const std::function<void(const glm::vec4& got, const Ray& ray, Interval inside)>& look) {
    for (uint32_t y = 0; y < kHeight; y += 3)
        for (uint32_t x = 0; x < kWidth; x += 3) {
            const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
            const Interval inside = insideTetrahedron(blob, ray);
            if (inside.length() > 0.05) look(picture.at(x, y), ray, inside);
        }
}

// Part of the peak's extinction at `t` m along the ray.
double partAt(const reference::Blob& blob, const Ray& ray, double t) {
    const glm::dvec3 off = ray.at(t) - blob.centre;
    return std::exp(-blob.k * blob.k * glm::dot(off, off));
}

TEST_F(GpuTest, TaylorIsItsDefinition) {
    const Pose pose = lookAt({0.5f, 1, 7}, {0, 0, 0}, 0.5f);
    for (const double depth : {0.5, 3.0}) {
        Scene scene = isvScene({thick({0, 0, 0}, 2, depth, 1.6f)}, "taylor");
        scene.lights[0].to_light = glm::normalize(glm::vec3(0.3f, 0.8f, 0.5f));
        const reference::Blob blob = blobsOf(scene)[0];
        const std::vector<reference::Blob> blobs{blob};
        const reference::LightField field(blobs, glm::normalize(glm::dvec3(scene.lights[0].to_light)));
        double worst = 0, of_series = 0, largest = 0;
        int black = 0, bright = 0;
        forRays(plain().see(scene, pose, kWidth, kHeight), pose, blob,
                [&](const glm::vec4& got, const Ray& ray, Interval inside) {
                    const double in = field.depth(ray.at(inside.begin)), out = field.depth(ray.at(inside.end));
                    const auto light = [&](double t) {
                        return glm::mix(in, out, (t - inside.begin) / inside.length());
                    };
                    const auto f = [&](double part) {
                        const double t = inside.begin + part * inside.length();
                        return blob.sigma_t * partAt(blob, ray, t) *
                               std::exp(-depthOn(blob, ray, {inside.begin, t}) - light(t));
                    };
                    const double second = (f(10 / 16.0) - 2 * f(9 / 16.0) + f(0.5)) * 16 * 16; // of the whole length
                    const double series = std::max(inside.length() * (f(0.5) + second / 24), 0.0);
                    const double exact = scatteredOn(blob, ray, inside, light);
                    worst = std::max(worst, std::abs(double(got.r) * 4 * kPi - series));
                    of_series = std::max(of_series, std::abs(series - exact));
                    largest = std::max(largest, exact);
                    black += series == 0 && exact > 0.1 * largest;
                    bright += series > 1.1 * exact;
                });
        // The shadow volume's interpolation, as in the test of the other quadratures. Differences of values a
        // sixteenth apart multiply it by at most 2.
        const double interpolation = depth * (4 / (33.0 * 33) + 0.49 / (16.0 * 16)) / 8;
        EXPECT_LT(worst, largest * (2 * interpolation + 1e-4)) << depth;
        EXPECT_GT(of_series, 0.3 * largest) << "the series was expected to fail";
        EXPECT_GT(black + bright, 30) << depth << ": pixels that are black or far too bright";
    }
}

// All of a tetrahedron has the extinction of its centre: what is seen through it, and what it scatters, are closed
// forms of the length of the ray in it. Each rule is its definition.
TEST_F(GpuTest, AnEvenTetrahedronIsItsClosedForm) {
    const Pose poses[] = {lookAt({0.5f, 1, 7}, {0, 0, 0}, 0.5f), lookAt({0.1f, 0.2f, 0.3f}, {0, 0, -1}, 1)};
    for (const float sigma_t : {0.05f, 0.8f})
        for (const char* quadrature : {"analytic", "simpson", "transmittance", "taylor"})
            for (const Pose& pose : poses) {
                SCOPED_TRACE(testing::Message() << sigma_t << ' ' << quadrature << ' ' << pose.position.z);
                const std::string name = quadrature;
                Scene scene = isvScene({{{0, 0, 0}, 2, sigma_t}}, quadrature);
                scene.render.isv.fading = false;
                scene.render.isv.steps = 3;
                const reference::Blob blob = blobsOf(scene)[0];
                const std::vector<reference::Blob> blobs{blob};
                const reference::LightField field(blobs, glm::normalize(glm::dvec3(scene.lights[0].to_light)));
                double worst = 0, largest = 0;
                forRays(plain().see(scene, pose, kWidth, kHeight), pose, blob,
                        [&](const glm::vec4& got, const Ray& ray, Interval inside) {
                            const double depth = double(sigma_t) * inside.length();
                            ASSERT_NEAR(double(got.a), std::exp(-depth), kTail);
                            const double in = field.depth(ray.at(inside.begin)), out = field.depth(ray.at(inside.end));
                            const auto f = [&](double part) {
                                return depth * std::exp(-depth * part - glm::mix(in, out, part));
                            };
                            double sum = 0;
                            if (name == "analytic") { // of light depth linear along the ray
                                const double x = depth + out - in;
                                sum = depth * std::exp(-in) * (std::abs(x) < 1e-6 ? 1 : -std::expm1(-x) / x);
                            } else if (name == "taylor") {
                                sum = f(0.5) + 256.0 / 24 * (f(10 / 16.0) - 2 * f(9 / 16.0) + f(0.5));
                            } else if (name == "simpson") {
                                for (int j = 0; j <= 6; ++j)
                                    sum += (j == 0 || j == 6 ? 1 : j % 2 ? 4 : 2) / 18.0 * f(j / 6.0);
                            } else {
                                const double nodes[] = {-std::sqrt(0.6), 0, std::sqrt(0.6)},
                                             weights[] = {5.0 / 18, 4.0 / 9, 5.0 / 18};
                                for (int i = 0; i < 3; ++i) {
                                    const double y = -std::expm1(-depth) * 0.5 * (1 + nodes[i]);
                                    const double t = inside.begin - std::log1p(-y) / double(sigma_t);
                                    sum += weights[i] * -std::expm1(-depth) * std::exp(-field.depth(ray.at(t)));
                                }
                            }
                            worst = std::max(worst, std::abs(double(got.r) * 4 * kPi - sum));
                            largest = std::max(largest, sum);
                        });
                const double interpolation = 2 * blob.half_line * (4 / (33.0 * 33) + 0.49 / (16.0 * 16)) / 8;
                EXPECT_LT(worst, largest * (2 * interpolation + 2e-4));
                EXPECT_GT(largest, 0.02);
            }
}

// What one place of each ray gets past a box, against the mean of 25 texels of the very map.
TEST_F(GpuTest, SoftShadowsAreMeansOfTwentyFiveTexels) {
    Scene scene = isvScene({thick({0, 0, 0}, 3, 0.01, 1.6f)});
    scene.render.isv.steps = 1;
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.3f, 1, 0.2f));
    scene.render.opaque_shadow_size = 48;
    const Pose pose = lookAt({0.5f, 1, 9}, {0, 0, 0}, 0.5f);
    const Picture open = plain().see(scene, pose, kWidth, kHeight);
    scene.boxes = {{{1.5f, 6, 1}, {2, 0.5f, 2.5f}, 0.4f, glm::vec3(0)}};
    const reference::Blob blob = blobsOf(scene)[0];

    const gpu::Tick tick = tickOf(scene, particlesOf(scene));
    OpaqueShadow shadow(device());
    recordAndWait(device(), tick, "Objects", opaqueObjects(scene),
                  [&](gpu::Commands& commands, gpu::Resources& shared) {
                      shadow.record(commands, shared, tick, opaqueObjects(scene));
                  });
    const std::vector<float> map = readImage(device(), shadow.image(), 1);
    const int size = int(tick.map.opaque_size);
    const auto lit = [&](glm::ivec2 texel, double height) {
        if (texel.x < 0 || texel.y < 0 || texel.x >= size || texel.y >= size) return 1.0;
        return height >= double(map[size_t(texel.y * size + texel.x)]) ? 1.0 : 0.0;
    };

    Stage stage(device(), scene, 1);
    for (const bool soft : {false, true}) {
        scene.render.isv.soft_shadows = soft;
        const Picture picture = stage.see(scene, pose, kWidth, kHeight);
        int compared = 0, between = 0, dark = 0;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
                const Interval inside = insideTetrahedron(blob, ray);
                if (inside.length() < 0.05 || open.at(x, y).r < 1e-5f) continue;
                double node = 0; // where the one step looks
                transmittanceSpace(blob, ray, inside, 1, [&](double t) { return node = t, 0.0; });
                const glm::dvec3 at = ray.at(node);
                const glm::dvec2 texel =
                    (glm::dvec2(glm::dot(at, glm::dvec3(tick.map.x)), glm::dot(at, glm::dvec3(tick.map.y))) -
                     glm::dvec2(tick.map.opaque_lo)) /
                    glm::dvec2(tick.map.opaque_hi - tick.map.opaque_lo) * double(size);
                const glm::dvec2 from_edge = glm::abs(glm::fract(texel) - 0.5);
                if (std::max(from_edge.x, from_edge.y) > 0.49) continue; // its texel is a matter of rounding
                double mean = 0;
                const int reach = soft ? 2 : 0;
                for (int v = -reach; v <= reach; ++v)
                    for (int u = -reach; u <= reach; ++u)
                        mean += lit(glm::ivec2(glm::floor(texel)) + glm::ivec2(u, v),
                                    glm::dot(at, glm::dvec3(tick.sun.to_light)));
                mean /= soft ? 25 : 1;
                ASSERT_NEAR(double(picture.at(x, y).r / open.at(x, y).r), mean, 2e-3) << x << ' ' << y;
                ++compared;
                dark += mean == 0;
                between += mean > 0 && mean < 1;
            }
        EXPECT_GT(compared, 800);
        EXPECT_GT(dark, 20);
        EXPECT_EQ(between > 100, soft);
    }
}

// A particle alone has eq. 11 on top of its single scattering; of many that lie in one place each adds it.
TEST_F(GpuTest, TheLegacyTermIsEquation11) {
    const Pose pose = lookAt({0.5f, 1, 7}, {0, 0, 0}, 0.5f);
    const auto added = [&](Scene scene, float multiple, bool fading) {
        scene.render.isv.fading = fading;
        scene.render.isv.multiple = 0;
        const Picture without = plain().see(scene, pose, kWidth, kHeight);
        scene.render.isv.multiple = multiple;
        Picture with = plain().see(scene, pose, kWidth, kHeight);
        for (size_t i = 0; i < with.pixels.size(); ++i) {
            EXPECT_EQ(with.pixels[i].a, without.pixels[i].a);
            with.pixels[i] -= without.pixels[i];
        }
        return with;
    };
    const Point one{{0, 0, 0}, 2, 0.01f, {1, 0.5f, 0.25f}};
    const Scene scene = isvScene({one});
    const reference::Blob blob = blobsOf(scene)[0];
    for (const bool fading : {true, false}) {
        int seen = 0;
        forRays(added(scene, 0.8f, fading), pose, blob, [&](const glm::vec4& got, const Ray& ray, Interval inside) {
            const double part = fading ? partAt(blob, ray, 0.5 * (inside.begin + inside.end)) : 1;
            if (depthOn(blob, ray, inside) < 1e-5) return; // may be left out
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(double(got[c]), double(one.albedo[c]) * 0.001 * 0.8 * part / (4 * kPi), 2e-8) << fading;
            ++seen;
        });
        EXPECT_GT(seen, 100);
    }
    const glm::uvec2 middle(kWidth / 2, kHeight / 2);
    const double alone = double(added(scene, 1, true).at(middle.x, middle.y).r),
                 of_twenty = double(added(isvScene(std::vector<Point>(20, {{0, 0, 0}, 2, 0.01f / 20})), 1, true)
                                        .at(middle.x, middle.y)
                                        .r);
    EXPECT_NEAR(of_twenty / alone, 20, 0.5) << "the same medium in twenty parts";
}

// render.cutoff bounds what ALL particles on a ray leave out. A cluster of particles, each just below what one of them
// may leave out, is not drawn at all; another cluster, just above, loses its rims.
TEST_F(GpuTest, TheCutOffBoundsTheSum) {
    constexpr float kCutoff = 0.05f;
    constexpr uint32_t kThin = 590;
    const double each = double(kCutoff) / (kThin + 10);
    for (const double depth : {0.98 * each, 3 * each})
        for (const char* method : {"isv", "even", "sphere"}) {
            std::vector<Point> points(kThin, thick({0, 0, 0}, 1, depth, 1.6f));
            for (int i = 0; i < 10; ++i) points.push_back(thick({100, 0, 0}, 4, 2, 1.6f)); // so that rims may be cut
            Scene scene = sceneOf(points, 1.6f);
            scene.render.method = method == std::string("even") ? "isv" : method;
            scene.render.isv.fading = method != std::string("even");
            scene.render.shadow_size = 32;
            const Pose pose = lookAt({0.3f, 0.2f, 5}, {0, 0, 0}, 0.5f);
            scene.render.cutoff = 0;
            const Picture all = plain().see(scene, pose, kWidth, kHeight);
            scene.render.cutoff = kCutoff;
            const Picture cut = plain().see(scene, pose, kWidth, kHeight);
            double most = 0;
            for (size_t i = 0; i < all.pixels.size(); ++i)
                most = std::max(most, std::log(double(cut.pixels[i].a)) - std::log(double(all.pixels[i].a)));
            EXPECT_LT(most, double(kCutoff) * (1 + 1e-3)) << method << ' ' << depth;
            EXPECT_GT(most, 0.8 * double(kCutoff)) << method << ' ' << depth << ": nothing was left out";
        }
}

} // namespace
} // namespace brume::test::isv_printed_test
