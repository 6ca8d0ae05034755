// The medium as every method shows it: sphere proxies against closed forms, furnaces, phase function.
#include <algorithm>
#include <cmath>

#include "common/phase_lobes.h"
#include "shaders/shared/phase.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/quadrature.h"
#include "tests/gpu/truth.h"

namespace brume::test::medium_test {
namespace {

constexpr uint32_t kWidth = 64, kHeight = 48;

struct Way { // to render
    const char *method, *quadrature;
    uint32_t steps;
};
constexpr Way kWays[] = {{"sphere", "", 1},       {"isv", "simpson", 1},       {"isv", "simpson", 10},
                         {"tiles", "cached", 1},  {"isv", "transmittance", 1}, {"isv", "transmittance", 3},
                         {"tiles", "hermite", 1}, {"isv", "analytic", 1}};
bool isWhole(const Way& way) { return way.method != std::string("isv"); } // the Gaussian that it sees

void choose(Scene& scene, const Way& way) {
    scene.render.method = way.method;
    setQuadrature(scene.render, way.quadrature);
    scene.render.isv.steps = way.steps;
}

class MediumTest : public GpuTest {
protected:
    void SetUp() override { plain(); }

    // Calls check(pixel, ray, x, y) for every pixel.
    template <class Check>
    static void forPixels(const Picture& picture, const Pose& pose, const Check& check) {
        for (uint32_t y = 0; y < picture.height; ++y)
            for (uint32_t x = 0; x < picture.width; ++x)
                check(glm::dvec4(picture.at(x, y)), rayThrough(pose, picture.width, picture.height, x, y), x, y);
    }

    // Transmittance of one particle drawn as a sphere against that of its whole Gaussian.
    static double worstTransmittance(const Point& point, float falloff, const Pose& pose) {
        const Scene scene = sceneOf({point}, falloff);
        const reference::Blob blob = blobsOf(scene)[0];
        double worst = 0;
        forPixels(plain().see(scene, pose, kWidth, kHeight), pose,
                  [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
                      const double error = std::abs(got.a - std::exp(-depthOn(blob, ray, wholeRay(ray))));
                      EXPECT_TRUE(std::isfinite(got.r) && std::isfinite(got.a)) << x << ' ' << y;
                      if (!(error <= worst)) worst = error;
                  });
        return worst;
    }
};

TEST_F(MediumTest, SphereHasTheTransmittanceOfItsGaussian) {
    for (const double depth : {0.01, 1.0, 20.0})
        for (const float falloff : {0.5f, 1.6f}) {
            const Point point = thick({1, -2, 3}, 1.5f, depth, falloff);
            const double k = std::sqrt(50) / (1.5 * double(falloff));
            for (const glm::vec3 from :
                 {glm::vec3(0, 0, 6), glm::vec3(-3, 2, 1.5f), glm::vec3(0.1f, -2.5f, 0), glm::vec3(80, 60, -50)}) {
                const double distance = double(glm::length(from));
                const Pose pose =
                    lookAt(point.centre + from, point.centre + 0.02f * from, distance > 20 ? 0.05f : 0.9f);
                EXPECT_LT(worstTransmittance(point, falloff, pose), allowed(distance, k, depth))
                    << depth << ' ' << falloff << ' ' << from.x;
            }
        }
    const Point far = thick({2000, 0, 0}, 6, 3, 1.6f);
    EXPECT_LT(worstTransmittance(far, 1.6f, lookAt({0, 300, 0}, far.centre, 0.01f)), allowed(2000, 0.74, 3));
}

// With the coarsest cut-off the sphere's rim shows: inside of it the depth is all there, outside of it there is
// nothing.
TEST_F(MediumTest, ProxiesCoverTheirSpheresAndNoMore) {
    constexpr double kCut = 1e-4; // the most that one particle may leave out
    const double rounding = std::max(
        0.0, subpixel(device()) - 1.0 / 256); // of proxies' vertices, pixels, beyond what the rim's 1e-3 allows for
    Random random(11);
    int inside = 0, straddling = 0;
    for (int i = 0; i < 100; ++i) {
        const float scale = random.uniform(0.5f, 20), falloff = i % 2 ? 1.6f : 0.7f;
        const glm::vec3 centre = random.inCube(5);
        const Point point = thick(centre, scale, double(random.uniform(0.1f, 4)), falloff);
        Scene scene = sceneOf({point}, falloff);
        scene.render.cutoff = 0.1f;
        scene.lights[0].to_light = random.direction();
        const reference::Blob blob = blobsOf(scene)[0];
        const double reach = std::sqrt(std::log(2 * blob.half_line / kCut)) / blob.k;
        const glm::vec3 away = random.direction() * float(reach);
        const glm::vec3 from = centre + away * random.uniform(0.3f, 2.5f);
        const glm::vec3 to = i % 3 ? from + random.direction() : centre + random.inCube(float(reach));
        const Pose pose = lookAt(from, to, random.uniform(0.4f, 2.6f));
        const double pixel = 2 * std::tan(0.5 * double(pose.fov_y)) / 30; // m per m of distance
        const glm::dvec3 view = glm::inverse(glm::dquat(pose.orientation)) * (blob.centre - glm::dvec3(from));
        straddling += glm::length(view) > reach && std::abs(view.z) < reach;
        forPixels(plain().see(scene, pose, 40, 30), pose, [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
            const glm::dvec3 to_centre = blob.centre - ray.eye;
            const double closest = glm::dot(to_centre, ray.w), b = glm::length(to_centre - closest * ray.w);
            if (std::abs(b - reach) < 1e-3 * reach + rounding * pixel * std::abs(closest)) return;
            double whole = 0, chord = 0;
            if (b < reach) {
                const double half = std::sqrt(reach * reach - b * b);
                chord = depthOn(blob, ray,
                                {std::max(ray.begin, closest - half), closest + half}); // where something may be cut
                whole = closest - half > ray.begin ? depthOn(blob, ray, wholeRay(ray)) : chord; // where nothing can be
                inside += chord > 0;
            }
            const double error = std::min(std::abs(got.a - std::exp(-whole)), std::abs(got.a - std::exp(-chord)));
            ASSERT_LT(error, allowed(2 * reach, blob.k, 2 * blob.half_line)) << i << ": " << x << ' ' << y;
        });
    }
    EXPECT_GT(inside, 20000);
    EXPECT_GT(straddling, 10);
}

// The eye a little outside of a large sphere, where the light's axes leave it outside the medium's bounds: what lies in
// front is seen, what lies behind is not, though the line through it meets the sphere.
TEST_F(MediumTest, NothingIsSeenBehindTheEye) {
    const float falloff = 1.6f, scale = 20;
    const Point point = thick({0, 0, 0}, scale, 2, falloff);
    const double reach = double(scale * falloff) * std::sqrt(std::log(2 / 1e-6) / 50),
                 k = std::sqrt(50.0) / double(scale * falloff);
    const glm::vec3 side = glm::normalize(glm::vec3(0.9f, 0.3f, 0.2f)), up = glm::normalize(glm::vec3(-0.3f, 0.9f, 0));
    Scene scene = sceneOf({point}, falloff);
    scene.lights[0].to_light = side;
    const reference::Blob blob = blobsOf(scene)[0];
    int covered = 0, behind = 0;
    for (const double away : {1.02, 1.06, 1.3})
        for (int turn = 0; turn < 12; ++turn)
            for (const float fov : {0.8f, 2.4f}) {
                const float angle = float(turn * kPi / 12);
                const Pose pose = lookAt(side * float(away * reach),
                                         side * (float(away * reach) - std::cos(angle)) + up * std::sin(angle), fov);
                forPixels(plain().see(scene, pose, 32, 24), pose,
                          [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
                              const double exact = std::exp(-depthOn(blob, ray, wholeRay(ray)));
                              ASSERT_NEAR(got.a, exact, allowed(reach, k, 2))
                                  << away << ' ' << turn << ' ' << fov << ": " << x << ' ' << y;
                              covered += exact < 0.99;
                              behind += depthOn(blob, ray, {-1e6, 1e6}) > 0.01 && exact > 0.99;
                          });
            }
    EXPECT_GT(covered, 1000);
    EXPECT_GT(behind, 1000);
}

// Two points of the Gaussian, whole or cut by the near plane: their definition, and how near the integral that is.
TEST_F(MediumTest, SphereScattersByTwoPoints) {
    const struct { double depth, bound; } cases[] = {{0.1, 0.005}, {0.5, 0.02}, {3, 0.1}};
    const Pose poses[] = {lookAt({0.5f, 1, 9}, {0, 0, 0}, 0.3f), lookAt({0.1f, 0.2f, 0.3f}, {0, 0, -1}, 1),
                          lookAt({0.2f, 0.3f, -0.5f}, {0, 1, -1.5f}, 1)};
    for (const auto& [depth, bound] : cases)
        for (const glm::vec3 to_light : {glm::vec3(0.3f, 0.8f, 0.5f), glm::vec3(0, 0, -1), glm::vec3(0, 0.1f, 1)})
            for (const Pose& pose : poses) {
                Scene scene = sceneOf({thick({0, 0, 0}, 2, depth, 1.6f)}, 1.6f);
                scene.lights[0].to_light = glm::normalize(to_light);
                scene.render.shadow_slices = 128;
                const auto blobs = blobsOf(scene);
                const reference::LightField field(blobs, glm::normalize(glm::dvec3(scene.lights[0].to_light)));
                double worst = 0, worst_of_rule = 0, largest = 0;
                forPixels(plain().see(scene, pose, 24, 18), pose,
                          [&](glm::dvec4 got, const Ray& ray, uint32_t, uint32_t) {
                              const auto light = [&](double t) { return field.depth(ray.at(t)); };
                              const double defined = twoPoints(blobs[0], ray, wholeRay(ray), light);
                              worst = std::max(worst, std::abs(got.r * 4 * kPi - defined));
                              const double exact = scatteredOn(blobs[0], ray, wholeRay(ray), light);
                              worst_of_rule = std::max(worst_of_rule, std::abs(defined - exact));
                              largest = std::max(largest, exact);
                          });
                // Interpolation in the shadow volume as in the test of isv's quadratures; its texels are 1/31 of 1/k
                // here.
                const double interpolation = depth * (4 / (31.0 * 31) + 0.49 / (15.0 * 15)) / 8;
                EXPECT_LT(worst, largest * (interpolation + 1e-4))
                    << depth << ' ' << to_light.z << ' ' << pose.position.z;
                EXPECT_LT(worst_of_rule, largest * bound) << depth << ' ' << to_light.z << ' ' << pose.position.z;
            }
}

// --- the whole ---

// The reference scene against the same model in double precision: particles one by one, far to near, each shadowed by
// all.
TEST_F(MediumTest, CloudAgreesWithTheDoublePrecisionReference) {
    constexpr int kSmallWidth = 28, kSmallHeight = 18;
    Scene scene = loadScene("server/scenes/cloud.toml");
    scene.render.cutoff = 1e-3f;
    const std::vector<gpu::Particle> particles = particlesOf(scene);
    const struct {
        Way way;
        double bound; // on the relative RMSE of radiance; the shadow volume of 256 x 256 x 16 alone makes 0.7 %
    } cases[] = {{{"sphere", "", 1}, 0.015},
                 {{"tiles", "hermite", 1}, 0.015},
                 {{"tiles", "cached", 1}, 0.025},
                 {{"isv", "simpson", 2}, 0.15},
                 {{"isv", "transmittance", 2}, 0.018}};
    for (const Pose& pose : {lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), lookAt({-9, 4, 12}, {1, 0, 0}, 0.9f)}) {
        const auto exactly = [&](reference::Model model) {
            return truePicture(
                reference::worldOf({particles, double(scene.medium.falloff), 0, 0}, scene.lights[0], model),
                reference::perspective(pose, kSmallWidth, kSmallHeight), 1e-8);
        };
        const reference::Picture whole = exactly(reference::Model::sequential),
                                 cut = exactly(reference::Model::sequential_tetrahedron);
        for (const auto& [way, bound] : cases) {
            choose(scene, way);
            const bool is_whole = isWhole(way);
            const reference::Picture& exact = is_whole ? whole : cut;
            std::vector<glm::dvec3> radiance;
            forPixels(plain().see(scene, pose, kSmallWidth, kSmallHeight), pose,
                      [&](glm::dvec4 got, const Ray&, uint32_t x, uint32_t y) {
                          radiance.push_back(got);
                          // The cut-off; and with isv, the rounding of a hundred silhouettes.
                          EXPECT_NEAR(got.a, exact.transmittance[y * kSmallWidth + x], is_whole ? 1e-3 : 2e-3)
                              << x << ' ' << y;
                      });
            EXPECT_LT(reference::relativeRmse(radiance, exact.radiance), bound) << way.method << ' ' << way.quadrature;
        }
    }
}

// --- furnaces ---

// Albedo 1 under uniform light from everywhere, in front of a sky as bright: 1 everywhere, whatever there is and in
// which order.
TEST_F(MediumTest, AmbientFurnace) {
    Scene scene = sceneOf(randomPoints(300, 8, 3, 1.5f), 1.6f);
    scene.lights.clear();
    scene.sky = {glm::vec3(1), glm::vec3(1), glm::vec3(1)};
    scene.render.shadow_size = 32;
    Stage stage(device(), scene, 300);
    const Pose poses[] = {lookAt({0, 2, 20}, {0, 0, 0}, 0.7f), lookAt({1, 0, 2}, {-1, 0, 0}, 1.5f),
                          lookAt({0, 30, 0}, {0, 0, 0}, 0.5f)};
    for (const Way& way : kWays) {
        choose(scene, way);
        for (const Pose& pose : poses) {
            double thickest = 1;
            forPixels(
                stage.see(scene, pose, kWidth, kHeight), pose, [&](glm::dvec4 got, const Ray&, uint32_t x, uint32_t y) {
                    // Up to 300 roundings of half an ulp of 1.
                    for (int c = 0; c < 3; ++c)
                        ASSERT_NEAR(got[c], 1, 2e-5) << way.method << ' ' << way.quadrature << ' ' << x << ' ' << y;
                    thickest = std::min(thickest, got.a);
                });
            EXPECT_LT(thickest, 0.3);
        }
    }
}

// Under the light alone: so thin that nothing shadows, every quadrature whose weights sum to 1 - T scatters just that.
TEST_F(MediumTest, FurnaceOfTheNormalisedQuadratures) {
    const double depth = 1e-4;
    const double rounding =
        std::max(0.0, subpixel(device()) - 1.0 / 256); // of vertices, pixels, beyond what is allowed for below
    const float falloff = 1.6f;
    for (const Way& way :
         {Way{"sphere", "", 1}, Way{"tiles", "cached", 1}, Way{"tiles", "hermite", 1}, Way{"isv", "transmittance", 1},
          Way{"isv", "transmittance", 2}, Way{"isv", "transmittance", 3}, Way{"isv", "analytic", 1}}) {
        Scene scene = sceneOf({thick({0, 0, 0}, 2, depth, falloff)}, falloff);
        scene.render.cutoff = 1e-9f;
        choose(scene, way);
        scene.lights[0].irradiance = glm::vec3(float(4 * kPi));
        const reference::Blob blob = blobsOf(scene)[0];
        const auto opacityOn = [&](const Ray& ray) {
            return -std::expm1(-depthOn(blob, ray, isWhole(way) ? wholeRay(ray) : insideTetrahedron(blob, ray)));
        };
        for (const Pose& pose : {lookAt({0.3f, 0.5f, 7}, {0, 0, 0}, 0.4f), lookAt({0.1f, 0.2f, 0.4f}, {0, 0, -1}, 1)}) {
            int compared = 0;
            forPixels(plain().see(scene, pose, kWidth, kHeight), pose,
                      [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
                          const Interval interval = isWhole(way) ? wholeRay(ray) : insideTetrahedron(blob, ray);
                          const double opacity = opacityOn(ray);
                          if (!isWhole(way) && interval.length() < 0.05) return; // silhouettes are drawn to 1/256 pixel
                          double slope = 0;                                      // per pixel
                          if (!isWhole(way))
                              for (const glm::uvec2 there : {glm::uvec2(x + 1, y), glm::uvec2(x, y + 1)}) {
                                  const Ray next = rayThrough(pose, kWidth, kHeight, there.x, there.y);
                                  slope = std::max(slope, std::abs(opacityOn(next) - opacity));
                              }
                          // At most 1e-4 of the light is lost; isv's interval errs by 1e-5 of its distance.
                          ASSERT_NEAR(got.r, opacity, opacity * (depth + 3e-4) + 2e-9 + slope * rounding)
                              << way.method << ' ' << way.quadrature << ' ' << x << ' ' << y;
                          compared += opacity > 1e-6;
                      });
            EXPECT_GT(compared, 500);
        }
    }
}

// --- phase function ---

TEST_F(MediumTest, TheLobeScalesEveryPixel) {
    Scene scene = sceneOf(randomPoints(40, 6, 2, 0.6f), 1.6f);
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.2f, 0.1f, -1)); // in view: the lobe's peak too
    const Pose pose = lookAt({0, 0, 9}, {0, 0, 0}, 1.3f);
    for (const Way& way : {kWays[0], kWays[2], kWays[3], kWays[6]}) {
        choose(scene, way);
        scene.medium.phase = kMixturePhase;
        scene.medium.anisotropy = 0;
        const Picture isotropic = plain().see(scene, pose, kWidth, kHeight);
        const struct {
            std::string_view phase;
            float a, g, second;
        } lobes[] = {{kMixturePhase, 1, 0.7f, 0},        {kMixturePhase, 0.4f, 0.9f, 0},
                     {kMixturePhase, 0.6f, -0.5f, 0},    {kMixturePhase, 1, 0, 0},
                     {kDoublePhase, 0, 0, 0.8f},         {kDoublePhase, 0.5f, 0.9f, -0.4f},
                     {kRayleighPhase, 0.3f, 0.3f, 0.3f}, {kDropletPhase, 0, 0, 0}};
        for (const auto& lobe : lobes) {
            scene.medium.phase = lobe.phase;
            scene.medium.anisotropy = lobe.a;
            scene.medium.asymmetry = lobe.g;
            scene.medium.second_asymmetry = lobe.second;
            const PhaseLobes p = lobesOf(scene.medium);
            const Picture picture = plain().see(scene, pose, kWidth, kHeight);
            forPixels(picture, pose, [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
                // Light travels along -to_light and then along -w.
                const double ratio = 4 * kPi *
                                     physics::phaseOfLobes(-glm::normalize(glm::dvec3(scene.lights[0].to_light)),
                                                           -ray.w, p.part, p.asymmetry, p.draine, p.second);
                const double plain_one = double(isotropic.at(x, y).r);
                ASSERT_NEAR(got.r, plain_one * ratio, 1e-5 * plain_one * ratio)
                    << lobe.phase << ' ' << lobe.a << ' ' << lobe.g << ' ' << x << ' ' << y;
                ASSERT_EQ(float(got.a), isotropic.at(x, y).a);
            });
        }
    }
}

} // namespace
} // namespace brume::test::medium_test
