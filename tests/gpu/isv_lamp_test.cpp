// Points and spots in the integral of method isv: closed forms of one particle, the double-precision reference, shadows
// of objects, and pictures that are drawn coarsely.
#include "tests/gpu/judged.h"
#include "tests/gpu/quadrature.h"

namespace brume::test::isv_lamp_test {
namespace {

const Pose kAside = lookAt({0.5f, 1, 7}, {0, 0, 0}, 0.5f);

class IsvLampTest : public JudgedTest {
protected:
    // Dark, but for one point.
    static Scene litScene(const std::vector<Point>& points, glm::vec3 position) {
        Scene scene = sceneOf(points, 1.6f);
        scene.render.method = "isv";
        setQuadrature(scene.render, "transmittance");
        scene.lights = {{.type = kPoint, .position = position, .intensity = glm::vec3(2), .radius = 0.05f}};
        return scene;
    }
    static float brightest(Stage& stage, const Scene& scene) {
        float most = 0;
        for (const glm::vec4& pixel : stage.see(scene, kAside, kWidth, kHeight).pixels) most = std::max(most, pixel.r);
        return most;
    }
};

// Sun et al., A practical analytic single scattering model for real time rendering, 2005: a point of 2 W/sr 4 m away in
// a medium of 0.3 1/m, 0.5 rad beside the line of sight, which ends after 9 m. The medium is one particle of 10 km,
// even to 4e-6 there. The near plane leaves out 3e-5 of the light. The bars are 1.5 times what was measured; with
// inverse squares at nodes transmittance 3 errs by 13 %.
TEST_F(IsvLampTest, APointInAnEvenMediumHasItsClosedForm) {
    Scene scene = litScene({{{0, 0, 0}, 1e4f, 0.3f}}, glm::vec3(std::sin(0.5f), 0, -std::cos(0.5f)) * 4.0f);
    scene.lights[0].radius = 0;
    scene.boxes = {{{0, 0, -59}, {200, 200, 100}, 0, glm::vec3(0)}};
    Stage stage(device(), scene, 1);
    const double expected = 0.010059723129;
    for (const auto& [name, steps, allowed] :
         {std::tuple("simpson", 10, 0.025), std::tuple("simpson", 2, 0.06), std::tuple("transmittance", 3, 0.007),
          std::tuple("analytic", 2, 0.009)}) {
        setQuadrature(scene.render, name);
        scene.render.isv.steps = uint32_t(steps);
        const Picture picture = stage.see(scene, lookAt({0, 0, 0}, {0, 0, -1}, 0.02f), 33, 33);
        const double error = double(picture.at(16, 16).r) / expected - 1;
        std::printf("%s %d: %.2e\n", name, steps, error);
        EXPECT_LT(std::abs(error), allowed) << name << ' ' << steps;
    }
}

// One particle with a point beside it, and with one inside: each pixel against the integral over the tetrahedron. The
// bars are 1.5 times what was measured. With inverse squares at nodes transmittance 3 errs by 28 % inside, Simpson 2 by
// 38 %.
TEST_F(IsvLampTest, OneParticleHasItsIntegral) {
    const struct {
        const char* quadrature;
        uint32_t steps;
        double beside, inside; // allowed: relative RMSE
    } rules[] = {{"simpson", 2, 0.065, 0.19},        {"simpson", 10, 0.006, 0.013},
                 {"transmittance", 1, 0.11, 0.16},   {"transmittance", 2, 0.015, 0.29},
                 {"transmittance", 3, 0.0093, 0.02}, {"analytic", 1, 0.015, 0.29}};
    for (const bool inside : {false, true}) {
        const glm::vec3 position = inside ? glm::vec3(0.3f, 0.2f, 0.1f) : glm::vec3(1, 2, 1.5f);
        Scene scene = litScene({thick({0, 0, 0}, 2, 1.5, 1.6f)}, position);
        const reference::Blob blob = blobsOf(scene)[0];
        const glm::dvec3 lamp(position);
        const double radius = double(scene.lights[0].radius);
        Stage stage(device(), scene, 1);
        for (const auto& rule : rules) {
            setQuadrature(scene.render, rule.quadrature);
            scene.render.isv.steps = rule.steps;
            const Picture picture = stage.see(scene, kAside, kWidth, kHeight);
            double errors = 0, values = 0;
            for (uint32_t y = 2; y < kHeight; y += kEvery)
                for (uint32_t x = 2; x < kWidth; x += kEvery) {
                    const Ray ray = rayThrough(kAside, kWidth, kHeight, x, y);
                    const Interval part = insideTetrahedron(blob, ray);
                    if (part.length() < 0.05) continue; // silhouettes are another test's
                    const double sum = scatteredOn(blob, ray, part, [&](double t) {
                        const glm::dvec3 away = ray.at(t) - lamp;
                        const double distance = glm::length(away);
                        const Ray from{lamp, away / std::max(distance, 1e-9), 0};
                        return depthOn(blob, from, {0, distance}) + std::log(distance * distance + radius * radius);
                    });
                    const double expected = 2 * sum / (4 * kPi), off = double(picture.at(x, y).r) - expected;
                    errors += off * off, values += expected * expected;
                }
            const double error = std::sqrt(errors / values), allowed = inside ? rule.inside : rule.beside;
            std::printf("%-13s %2u, %s: %.3f %%\n", rule.quadrature, rule.steps, inside ? "inside" : "beside",
                        100 * error);
            EXPECT_LT(error, allowed) << rule.quadrature << ' ' << rule.steps << ' ' << inside;
        }
    }
}

// A lamp among 2,500 particles over the ground, of a lobe. What is left is tetrahedra that are cut off, and one drawn
// after another: 1.5 %. With inverse squares at nodes it is 3.1 %.
TEST_F(IsvLampTest, ALampInSmoke) {
    Scene scene = loadScene("server/scenes/lamp.toml");
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0)};
    scene.render.method = "isv";
    setQuadrature(scene.render, "transmittance");
    scene.render.isv.steps = 2;
    const Error error = errorOf(scene, lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y));
    std::printf("lamp: %.3f %%, worst pixel %.2f %%\n", 100 * error.rmse, 100 * error.worst);
    EXPECT_LT(error.rmse, 0.022);
}

// A box between a lamp and all of a particle, a plane above which the lamp is below, a spot that looks away.
TEST_F(IsvLampTest, HiddenLampsLightNothing) {
    Scene scene = litScene({thick({0, 0, 0}, 1, 1, 1.6f)}, {0, 6, 0});
    scene.boxes = {{{0, 3, 0}, {6, 0.5f, 6}, 0, glm::vec3(0)}};
    Stage stage(device(), scene, 1);
    for (const char* quadrature : {"simpson", "transmittance", "analytic", "taylor"}) {
        setQuadrature(scene.render, quadrature);
        scene.lights[0].shadows = true;
        scene.lights[0].position = {0, 6, 0};
        EXPECT_EQ(brightest(stage, scene), 0) << quadrature;
        scene.lights[0].shadows = false;
        EXPECT_GT(brightest(stage, scene), 1e-4f) << quadrature;
        scene.lights[0].shadows = true;
        scene.lights[0].position = {3, 0, 3};
        EXPECT_GT(brightest(stage, scene), 1e-4f) << quadrature << ", beside the box";
        scene.lights[0].range = 2;
        EXPECT_EQ(brightest(stage, scene), 0) << quadrature << ", out of range";
        scene.lights[0].range = 1e15f;
        scene.lights[0].type = kSpot;
        scene.lights[0].axis = {0, 1, 0};
        scene.lights[0].inner = 0.1f, scene.lights[0].outer = 0.2f;
        EXPECT_EQ(brightest(stage, scene), 0) << quadrature << ", beside the cone";
        scene.lights[0].type = kPoint;
    }
}

// Every 4th pixel has its own bins of lights: those of the whole picture are for other pixels. 0.17 % was measured.
TEST_F(IsvLampTest, DrawnCoarselyWithItsOwnBins) {
    Scene scene = litScene(randomPoints(60, 5, 2.5f, 0.2f), {0, 0, 0});
    scene.lights = {};
    for (const float x : {-3.0f, 3.0f})
        for (const float y : {-2.0f, 2.0f})
            scene.lights.push_back(
                {.type = kPoint, .position = {x, y, 0}, .intensity = {9, 8, 6}, .range = 2, .radius = 1});
    scene.planes = {{-4, glm::vec3(0.4f, 0.35f, 0.3f)}};
    const Pose pose = lookAt({0, 1, 12}, {0, 0, 0}, 0.6f);
    Stage stage(device(), scene, 60);
    const auto seen = [&](uint32_t rate) {
        scene.render.rate = rate;
        return stage.see(scene, pose, 2 * kWidth, 2 * kHeight);
    };
    const Picture all = seen(1), coarse = seen(4);
    double errors = 0, values = 0;
    for (size_t i = 0; i < all.pixels.size(); ++i) {
        const glm::dvec3 x(coarse.pixels[i]), y(all.pixels[i]);
        errors += glm::dot(x - y, x - y), values += glm::dot(y, y);
    }
    const double off = std::sqrt(errors / values);
    std::printf("every 4th pixel: %.3f %%\n", 100 * off);
    EXPECT_GT(values, 0);
    EXPECT_GT(off, 1e-7);
    EXPECT_LT(off, 0.0026);
}

} // namespace
} // namespace brume::test::isv_lamp_test
