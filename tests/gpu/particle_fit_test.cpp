// The light on particles that viewers get who draw by themselves: against double precision, past objects, in colours.
#include <cmath>

#include "server/render/renderer.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/fixture.h"

namespace brume::test::particle_fit_test {
namespace {

struct Lit {
    std::vector<gpu::Particle> particles;
    std::vector<std::vector<gpu::ParticleFit>> fits; // of each hue
};

Lit litOf(const gpu::Device& device, const Scene& scene) {
    const Simulation simulation(scene);
    Renderer renderer(device, scene, simulation.capacity());
    Submission submission(device, "light");
    renderer.submitLight(submission, simulation, scene.render);
    waitFor(submission.commands);
    const Submission::Fits& fits = submission.fits();
    Lit lit{fits.particles, {}};
    for (const auto& hue : fits.fits) lit.fits.emplace_back(hue.begin(), hue.end());
    return lit;
}

std::vector<Point> randomPoints(int count, float half, float scale, float sigma) {
    Random random(11);
    std::vector<Point> points;
    for (int i = 0; i < count; ++i)
        points.push_back({random.inCube(half), random.uniform(0.8f, 1.2f) * scale, random.uniform(0.5f, 1.5f) * sigma});
    return points;
}

TEST_F(GpuTest, ParticleFitsAreThoseOfExactLight) {
    Scene scene = sceneOf(randomPoints(300, 4, 4, 0.05f), 1.6f);
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.3f, 0.8f, 0.5f));
    const reference::LightField field(blobsOf(scene), glm::normalize(glm::dvec3(scene.lights[0].to_light)));
    const Lit lit = litOf(device(), scene);
    ASSERT_EQ(lit.fits.size(), 1u);
    ASSERT_EQ(lit.fits[0].size(), 300u);
    const auto square = [](double x) { return x * x; };
    double middle = 0, slope = 0, bend = 0, twist = 0, steepest = 0, most_bent = 0;
    for (size_t i = 0; i < lit.particles.size(); ++i) {
        const gpu::Particle& p = lit.particles[i];
        const gpu::ParticleFit& fit = lit.fits[0][i];
        const double k = std::sqrt(50.0) / double(p.scale * scene.medium.falloff), reach = double(gpu::kFitReach);
        const auto at = [&](glm::dvec3 u) { return std::exp(-field.depth(glm::dvec3(p.centre) + u / k)); };
        const double there = at({0, 0, 0});
        middle += square(double(fit.middle) - there);
        for (int j = 0; j < 3; ++j) {
            glm::dvec3 axis(0), same(0), other(0);
            axis[j] = reach;
            same[(j + 1) % 3] = same[(j + 2) % 3] = other[(j + 1) % 3] = std::sqrt(0.5) * reach;
            other[(j + 2) % 3] = -same[(j + 2) % 3];
            const double rises = (at(axis) - at(-axis)) / (2 * reach),
                         bends = (0.5 * (at(axis) + at(-axis)) - there) / (reach * reach),
                         twists = (at(same) + at(-same) - at(other) - at(-other)) / (4 * reach * reach);
            slope += square(double(fit.slope[j]) - rises);
            bend += square(double(fit.bend[j]) - bends);
            twist += square(double(fit.twist[j]) - twists);
            steepest = std::max(steepest, std::abs(rises));
            most_bent = std::max(most_bent, std::max(std::abs(bends), std::abs(twists)));
        }
    }
    EXPECT_GT(steepest, 0.1) << "there is something to fit";
    EXPECT_GT(most_bent, 0.03);
    // The shadow volume's own error, of the light's transmittance: the root of the mean square.
    EXPECT_LT(std::sqrt(middle / 300), 0.006);
    EXPECT_LT(std::sqrt(slope / 900), 0.004);
    EXPECT_LT(std::sqrt(bend / 900), 0.005);
    EXPECT_LT(std::sqrt(twist / 900), 0.004);
}

// Whole shadows are dark, none are lit; an edge through a particle is a slope.
TEST_F(GpuTest, ParticleFitsKnowShadowsOfObjects) {
    std::vector<Point> points;
    for (const float x : {-6.0f, 0.0f, 2.0f, 6.0f}) points.push_back({{x, 0, 0}, 2, 1e-4f});
    Scene scene = sceneOf(points, 1);
    scene.lights[0].to_light = {0, 1, 0};
    scene.boxes.push_back({.centre = {0, 5, 0}, .size = {4, 1, 4}});
    const Lit lit = litOf(device(), scene);
    const auto& fits = lit.fits.at(0);
    EXPECT_NEAR(fits[0].middle, 1, 1e-3);
    EXPECT_NEAR(fits[1].middle, 0, 1e-6);
    EXPECT_EQ(fits[1].slope, glm::vec3(0));
    EXPECT_GT(fits[2].slope.x, 0.3f) << "the box ends at x = 2";
    EXPECT_NEAR(fits[2].slope.z, 0, 1e-3);
    EXPECT_NEAR(fits[3].middle, 1, 1e-3);
}

TEST_F(GpuTest, ParticleFitsOfEachHueAndOfLightThatScattersOn) {
    Scene scene = sceneOf(randomPoints(200, 4, 4, 0.05f), 1.6f);
    scene.medium.extinction_colour = {0.25f, 0.5f, 1};
    scene.render.scattering = "propagation";
    const Lit lit = litOf(device(), scene);
    ASSERT_EQ(lit.fits.size(), 3u);
    for (size_t i = 0; i < 200; ++i) {
        const float red = lit.fits[0][i].middle, green = lit.fits[1][i].middle, blue = lit.fits[2][i].middle;
        EXPECT_NEAR(green, std::pow(blue, 0.5f), 2e-3f) << "depths are in proportion";
        EXPECT_NEAR(red, std::pow(blue, 0.25f), 2e-3f);
        EXPECT_GT(lit.fits[2][i].fluence[0].w, 0);
        EXPECT_LE(glm::length(glm::vec3(lit.fits[2][i].fluence[0])), lit.fits[2][i].fluence[0].w * 1.01f)
            << "no more goes than there is";
    }
    scene.render.scattering = "single";
    const Lit single = litOf(device(), scene);
    for (const gpu::ParticleFit& fit : single.fits[0]) EXPECT_EQ(fit.fluence[0], glm::vec4(0));
}

// Groups of a large medium are lit by all of its particles.
TEST_F(GpuTest, ParticleFitsOfGroupsAreThoseOfTheirPlaces) {
    Scene scene = sceneOf(randomPoints(200, 4, 4, 0.05f), 1.6f);
    const Lit all = litOf(device(), scene);
    const Simulation simulation(scene);
    Renderer renderer(device(), scene, simulation.capacity());
    Submission submission(device(), "light");
    const std::vector<gpu::Particle> groups(all.particles.begin() + 50, all.particles.begin() + 60);
    renderer.submitLight(submission, simulation, scene.render, groups);
    waitFor(submission.commands);
    const Submission::Fits& fits = submission.fits();
    ASSERT_EQ(fits.particles.size(), 10u);
    for (size_t i = 0; i < 10; ++i) {
        EXPECT_EQ(fits.particles[i].centre, groups[i].centre);
        EXPECT_EQ(fits.fits[0][i].middle, all.fits[0][50 + i].middle);
        EXPECT_EQ(fits.fits[0][i].twist, all.fits[0][50 + i].twist);
    }
}

TEST_F(GpuTest, ParticleFitsOfNoParticles) {
    Scene scene = sceneOf({}, 1);
    scene.medium.layout = Layout::none;
    EXPECT_TRUE(litOf(device(), scene).particles.empty());
}

} // namespace
} // namespace brume::test::particle_fit_test
