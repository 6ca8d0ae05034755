// Light that particles emit, by every method, against closed forms and the reference.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/gpu/fixture.h"
#include "tests/gpu/truth.h"

namespace brume::test::emission_test {
namespace {

constexpr uint32_t kWidth = 64, kHeight = 48;
const glm::vec3 kAlbedo{0.25f, 0.5f, 1};
const Pose kOutside = lookAt({0, 2, 20}, {0, 0, 0}, 0.7f), kInside = lookAt({1, 0, 2}, {-1, 0, 0}, 1.5f);

class EmissionTest : public GpuTest {
protected:
    static std::vector<const char*> methods() {
        return {"sphere", "isv", "tiles", "slabs", "grid", "march", "froxels", "lit", "gradients"};
    }
    static bool drawsFog(const std::string& method) {
        return method != "sphere" && method != "isv" && method != "tiles";
    }
    // Particles of all albedos.
    static Scene mixed() {
        std::vector<Point> points = randomPoints(200, 8, 3, 1.5f);
        Random random(4);
        for (Point& p : points) p.albedo = {random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)};
        Scene scene = sceneOf(points, 1.6f);
        scene.lights.clear();
        scene.render.shadow_size = 32;
        scene.render.froxels.pixels = 1; // cells of more are too coarse for these pictures
        return scene;
    }
};

// What scatters a light of 1 from everywhere, and emits what it does not scatter, is as bright as the sky behind it,
// whatever its albedos are.
TEST_F(EmissionTest, SootAsBrightAsTheSkyCannotBeSeen) {
    for (const bool fog : {false, true}) {
        Scene scene = mixed();
        scene.sky = {.zenith = glm::vec3(1), .horizon = glm::vec3(1), .ambient = glm::vec3(1)};
        scene.medium.emission = glm::vec3(1);
        if (fog) scene.fogs = {{.extinction = 0.02f, .albedo = {0.9f, 0.5f, 0}, .emission = glm::vec3(1)}};
        for (const char* method : some(methods())) {
            if (fog && !drawsFog(method)) continue;
            scene.render.method = method;
            for (const Pose& pose : {kOutside, kInside}) {
                const Picture picture = render(device(), scene, pose, kWidth, kHeight);
                float off = 0, through = 1;
                for (const glm::vec4& pixel : picture.pixels) {
                    through = std::min(through, pixel.a);
                    for (int c = 0; c < 3; ++c) off = std::max(off, std::abs(pixel[c] - 1));
                }
                std::printf("%s%s: %.1e\n", method, fog ? " with fog" : "", double(off));
                EXPECT_LE(off, 2e-5f) << method;
                EXPECT_LT(through, 0.3f) << method;
            }
        }
    }
}

// Without any other light, of one albedo: (1 - albedo) E (1 - T), as a medium of one temperature.
TEST_F(EmissionTest, EmitsByWhatItHides) {
    std::vector<Point> points = randomPoints(200, 8, 3, 1.5f);
    for (Point& p : points) p.albedo = kAlbedo;
    Scene scene = sceneOf(points, 1.6f);
    scene.lights.clear();
    scene.render.froxels.pixels = 1;
    scene.medium.emission = {3, 2, 5};
    for (const char* method : some(methods())) {
        scene.render.method = method;
        const Picture picture = render(device(), scene, kOutside, kWidth, kHeight);
        double off = 0;
        for (const glm::vec4& pixel : picture.pixels)
            for (int c = 0; c < 3; ++c) {
                const double emitted = (1 - double(kAlbedo[c])) * double(scene.medium.emission[c]);
                off = std::max(off, std::abs(double(pixel[c]) - emitted * (1 - double(pixel.a))));
            }
        std::printf("%s: %.1e\n", method, off);
        EXPECT_LE(off, 2e-5) << method;
    }
}

// The union of balls and tetrahedra emit as well.
TEST_F(EmissionTest, OtherMediaDoToo) {
    Scene scene = sceneOf({{{-2, 0, 0}, 2, 1, kAlbedo},
                           {{2, 0, 1}, 2, 1, kAlbedo},
                           {{0, 3, 0}, 2, 2, kAlbedo},
                           {{0, 0, -3}, 2, 0.5f, kAlbedo}},
                          1.6f, {{0, 1, 2, 3}});
    scene.lights.clear();
    scene.medium.emission = {3, 2, 5};
    Scene balls = sceneOf({{{0, 0, 0}, 20, 1, kAlbedo}}, 1.6f);
    balls.lights.clear();
    balls.medium.model = kUnionMedium;
    balls.medium.albedo = kAlbedo;
    balls.medium.emission = scene.medium.emission;
    for (Scene* one : {&scene, &balls}) {
        one->render.method = one == &scene ? "tetrahedra" : "sprites";
        const Picture picture = render(device(), *one, kOutside, kWidth, kHeight);
        double off = 0, through = 1;
        for (const glm::vec4& pixel : picture.pixels) {
            through = std::min(through, double(pixel.a));
            for (int c = 0; c < 3; ++c) {
                const double emitted = (1 - double(kAlbedo[c])) * double(one->medium.emission[c]);
                off = std::max(off, std::abs(double(pixel[c]) - emitted * (1 - double(pixel.a))));
            }
        }
        EXPECT_LE(off, 2e-5) << one->render.method;
        EXPECT_LT(through, 0.7) << one->render.method;
    }
}

} // namespace
} // namespace brume::test::emission_test
