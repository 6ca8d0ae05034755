// Method isv as the dissertation's program has it: particles dropped at the near plane, the fixed early return, and the
// step of the Taylor series.
#include <cmath>

#include "tests/gpu/closed_form.h"
#include "tests/gpu/quadrature.h"

namespace brume::test::isv_options_test {
namespace {

constexpr uint32_t kWidth = 96, kHeight = 72;

Scene isvScene(const std::vector<Point>& points) {
    Scene scene = sceneOf(points, 1.6f);
    scene.render.method = "isv";
    scene.render.shadow_size = 256;
    scene.render.shadow_slices = 128;
    return scene;
}

int seenPixels(const Picture& picture) {
    int seen = 0;
    for (const glm::vec4& pixel : picture.pixels) seen += pixel.a < 1;
    return seen;
}

// Dropped is what has its ball in front of the near plane in part, though its tetrahedron may lie behind it.
TEST_F(GpuTest, DroppedAtTheNearPlane) {
    const float near_depth = float(kNearDepth);
    for (const char* orientation : {"aligned", "random"})
        for (const float before : {-1.5f, -0.5f, -0.01f, 0.01f, 2.0f}) { // m, from the plane to the ball
            SCOPED_TRACE(testing::Message() << orientation << ' ' << before);
            Scene scene = isvScene({{{0.2f, 0.1f, -(near_depth + 2 + before)}, 2, 1}, {{0.3f, 0, -20}, 4, 1}});
            scene.render.isv.orientation = orientation;
            const Pose pose = lookAt({0, 0, 0}, {0, 0, -1}, 0.9f);
            const Picture clipped = plain().see(scene, pose, kWidth, kHeight);
            scene.render.isv.near = "drop";
            const Picture dropped = plain().see(scene, pose, kWidth, kHeight),
                          without_mesh = plainWithoutMesh().see(scene, pose, kWidth, kHeight);
            Scene far = scene;
            far.medium.file = isvScene({{{0, 0, 50}, 2, 1}, {{0.3f, 0, -20}, 4, 1}}).medium.file;
            far.lights[0].irradiance = glm::vec3(0); // the first one shadows, dropped or not
            const Picture alone = plain().see(far, pose, kWidth, kHeight);
            const Picture& expected = before > 0 ? clipped : alone;
            int differ = 0;
            for (size_t i = 0; i < dropped.pixels.size(); ++i) {
                ASSERT_EQ(dropped.pixels[i].a, expected.pixels[i].a) << i;
                ASSERT_NEAR(dropped.pixels[i].a, without_mesh.pixels[i].a, 2e-6f) << i;
                differ += clipped.pixels[i].a != alone.pixels[i].a;
            }
            EXPECT_GT(differ, 300) << "the particle would be seen";
            EXPECT_GT(seenPixels(alone), 100);
        }
}

// What is left out: depths below a particle's share, below 0.001 whatever there is, or nothing.
TEST_F(GpuTest, EarlyReturns) {
    const Pose pose = lookAt({0.5f, 1, 7}, {0, 0, 0}, 0.5f);
    Scene scene = isvScene({thick({0, 0, 0}, 2, 0.3, 1.6f)});
    scene.render.cutoff = 1e-4f;
    const reference::Blob blob = blobsOf(scene)[0];
    int seen[3] = {};
    for (const auto& [index, name, least] :
         {std::tuple(0, "sum", 1e-4), std::tuple(1, "fixed", 1e-3), std::tuple(2, "none", 0.0)}) {
        scene.render.isv.early_return = name;
        const Picture picture = plain().see(scene, pose, kWidth, kHeight);
        seen[index] = seenPixels(picture);
        int out = 0;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
                const Interval inside = insideTetrahedron(blob, ray);
                if (inside.length() < 0.05) continue;
                const double depth = depthOn(blob, ray, inside);
                if (std::abs(depth / least - 1) < 0.02) continue;
                const float a = picture.at(x, y).a;
                if (depth < least) {
                    ASSERT_EQ(a, 1) << name << ' ' << depth;
                    ++out;
                } else {
                    ASSERT_NEAR(double(a), std::exp(-depth), 5e-5) << name;
                    if (depth > 1e-6) {
                        ASSERT_LT(a, 1) << name << ' ' << depth;
                    }
                }
            }
        EXPECT_EQ(out > 50, least > 0) << name << ' ' << out;
    }
    EXPECT_LT(seen[1], seen[0]);
    EXPECT_LT(seen[0], seen[2]);
}

// The series with differences of its own step, m. With so small a step as the program's, float32 leaves little of them.
TEST_F(GpuTest, TaylorHasAStepOfItsOwn) {
    const Pose pose = lookAt({0.5f, 1, 7}, {0, 0, 0}, 0.5f);
    Scene scene = isvScene({thick({0, 0, 0}, 2, 0.5, 1.6f)});
    setQuadrature(scene.render, "taylor");
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.3f, 0.8f, 0.5f));
    const std::vector<reference::Blob> blobs = blobsOf(scene);
    const reference::Blob blob = blobs[0];
    const reference::LightField field(blobs, glm::normalize(glm::dvec3(scene.lights[0].to_light)));
    double noise = 0;
    for (const double step : {0.3, 0.05, 0.001}) {
        scene.render.isv.taylor_step = float(step);
        const Picture picture = plain().see(scene, pose, kWidth, kHeight);
        double worst = 0, largest = 0;
        for (uint32_t y = 0; y < kHeight; y += 3)
            for (uint32_t x = 0; x < kWidth; x += 3) {
                const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
                const Interval inside = insideTetrahedron(blob, ray);
                if (inside.length() < 0.2) continue;
                const double in = field.depth(ray.at(inside.begin)), out = field.depth(ray.at(inside.end));
                const double middle = 0.5 * (inside.begin + inside.end), length = inside.length();
                const auto f = [&](double t) {
                    const glm::dvec3 off = ray.at(t) - blob.centre;
                    return blob.sigma_t * std::exp(-blob.k * blob.k * glm::dot(off, off)) *
                           std::exp(-depthOn(blob, ray, {inside.begin, t}) -
                                    glm::mix(in, out, (t - inside.begin) / length));
                };
                const double second = (f(middle + 2 * step) - 2 * f(middle + step) + f(middle)) / (step * step);
                const double series = std::max(length * (f(middle) + length * length * second / 24), 0.0);
                worst = std::max(worst, std::abs(double(picture.at(x, y).r) * 4 * kPi - series));
                largest = std::max(largest, series);
            }
        ASSERT_GT(largest, 0.05);
        // Differences multiply what float32 and the shadow volume leave: 4 of them, L^2 / 24 step^2 each, with L up to
        // 3.3 m.
        const double errors = 4 * 3.3 * 3.3 / 24 / (step * step);
        if (step > 0.01) {
            EXPECT_LT(worst, largest * (1e-4 + 3e-7 * errors) + 2e-3) << step;
        } else {
            noise = worst;
        }
    }
    EXPECT_GT(noise, 0.01) << "with 1 mm the differences are noise";
}

// As in the program, where the series knows no shadows of objects.
TEST_F(GpuTest, TaylorMayLeaveOutShadows) {
    const Pose pose = lookAt({0.5f, 1, 7}, {0, 0, 0}, 0.5f);
    Scene scene = isvScene({thick({0, 0, 0}, 2, 0.5, 1.6f)});
    scene.lights[0].to_light = {0, 1, 0};
    scene.boxes = {{{0, 20, 0}, {30, 1, 30}, 0, glm::vec3(0)}};
    setQuadrature(scene.render, "taylor");
    Stage stage(device(), scene, 1);
    const auto brightest = [&] {
        float most = 0;
        for (const glm::vec4& pixel : stage.see(scene, pose, kWidth, kHeight).pixels) most = std::max(most, pixel.r);
        return most;
    };
    EXPECT_EQ(brightest(), 0);
    scene.render.isv.taylor_shadows = false;
    EXPECT_GT(brightest(), 1e-3f);
    setQuadrature(scene.render, "simpson");
    EXPECT_EQ(brightest(), 0) << "of the series alone";
}

} // namespace
} // namespace brume::test::isv_options_test
