// What plans are made of, without a device: laws of the error, the medium as a view shows it, and work.
#include <utility>

#include <gtest/gtest.h>

#include "server/medium/band_limit.h"
#include "server/methods/rays/ray_plan.h"
#include "tests/unit/plan_scenes.h"

namespace brume {
namespace {

TEST(MediumExtent, ItsDepthsAreThoseOfItsCorners) {
    MediumExtent extent;
    extent.lo = {-3, 0.5f, 2}, extent.hi = {1, 4, 2.5f};
    for (const glm::vec3 ahead :
         {glm::vec3(0, 0, -1), glm::vec3(1, 2, 3), glm::vec3(-5, 0.1f, 0), glm::vec3(0.3f, -1, -0.2f)}) {
        const glm::vec3 eye(7, -2, 1), forward = glm::normalize(ahead);
        float near = 1e30f, far = -1e30f;
        for (int i = 0; i < 8; ++i) {
            const glm::vec3 corner = glm::mix(extent.lo, extent.hi, glm::vec3(i & 1, i >> 1 & 1, i >> 2));
            near = std::min(near, glm::dot(corner - eye, forward));
            far = std::max(far, glm::dot(corner - eye, forward));
        }
        EXPECT_NEAR(depthRange(extent, eye, forward).near, near, 1e-5f);
        EXPECT_NEAR(depthRange(extent, eye, forward).far, far, 1e-5f);
    }
}

// Where a law is below what was found it is by no more than this: the plan's error is then off by less than a third.
constexpr double kBelow = 1.3;

// Errors of one Gaussian by itself, integrated in double with the shaders' formulas at random phases of slabs and rays.
TEST(ErrorLaws, OfSlabsBoundThatOfOneBall) {
    struct Found {
        double depth, thickness, error; // through its centre; in standard deviations; lit from the side
    };
    for (const Found& f : {Found{1, 0.5, 0.00026}, Found{1, 0.7, 0.001}, Found{1, 1, 0.00415}, Found{1, 1.4, 0.0145},
                           Found{5, 0.5, 0.00036}, Found{5, 0.7, 0.00108}, Found{5, 1, 0.0041}, Found{5, 1.4, 0.0224},
                           Found{30, 0.7, 0.0031}, Found{30, 1, 0.0149}, Found{30, 1.4, 0.0434}}) {
        const double law = slabError(f.thickness, SeenLight::bendOf(f.depth), f.depth / 2);
        EXPECT_GT(kBelow * law, f.error) << f.depth << ' ' << f.thickness;
        EXPECT_LT(law, 4.5 * f.error) << f.depth << ' ' << f.thickness << ": needlessly fine";
    }
    EXPECT_LT(slabError(0.5, SeenLight::bendOf(0.001), 0), 1e-6) << "a thin medium is nearly linear";
}

TEST(ErrorLaws, OfRaysBoundThatOfOneGaussian) {
    for (const auto& [spacing, error] : {std::pair(0.4, 0.00041), std::pair(0.5, 0.00072), std::pair(0.6, 0.00142),
                                         std::pair(0.7, 0.0031), std::pair(0.8, 0.0067), std::pair(0.9, 0.0129),
                                         std::pair(1.0, 0.0224), std::pair(1.2, 0.0525), std::pair(1.5, 0.125)}) {
        EXPECT_GT(kBelow * rayError(spacing), error) << spacing;
        EXPECT_LT(rayError(spacing), 2 * error) << spacing;
    }
}

// Thin, in slabs two and three deviations thick, 10 and 20 degrees off the view axis.
TEST(ErrorLaws, OfWidenedParticlesBoundThatOfOneGaussian) {
    for (const auto& [thickness, degrees, error] : {std::tuple(2.0, 10.0, 0.0124), std::tuple(3.0, 10.0, 0.042),
                                                    std::tuple(2.0, 20.0, 0.0456), std::tuple(3.0, 20.0, 0.14)}) {
        const double oblique = std::pow(std::tan(degrees * 3.14159265358979 / 180), 2);
        EXPECT_GT(kBelow * widenedError(thickness, oblique), error) << thickness << ' ' << degrees;
        EXPECT_LT(widenedError(thickness, oblique), 2 * error) << thickness << ' ' << degrees;
    }
    EXPECT_EQ(widenedError(1.4, 0.1), 0);
    EXPECT_EQ(endsError(1.4, 8), 0);
}

// Between rays an edge is smeared: fogs with a ball or ends in height ask for more of them.
TEST(ErrorLaws, OfFogsWithEdges) {
    Scene scene = cube();
    const auto errorAt = [&](uint32_t rate) {
        const PlanInputs inputs = inputsOf(scene);
        return fogError(ViewWork(inputs.scene, inputs.views[0]), rate);
    };
    EXPECT_EQ(errorAt(4), 0);
    scene.fogs.emplace_back();
    scene.fogs[0].falloff = 0.1f;
    EXPECT_EQ(errorAt(4), 0);
    scene.fogs[0].radius = 3;
    EXPECT_EQ(errorAt(1), 0);
    EXPECT_NEAR(errorAt(4), 0.0042, 2e-4); // 640x360
    EXPECT_GT(errorAt(8), errorAt(4));
    scene.fogs[0].extinction = 0;
    EXPECT_EQ(errorAt(4), 0);
}

TEST(SeenLight, OfOneBallHasItsSizeAndAllOfIt) {
    const Scene scene = cube(1);
    const PlanInputs inputs = inputsOf(scene);
    const ViewWork view(inputs.scene, inputs.views[0]);
    ASSERT_EQ(view.light().sizes().size(), 1u);
    const SeenLight::Size& size = view.light().sizes()[0];
    EXPECT_NEAR(size.part, 1, 1e-9);
    EXPECT_NEAR(size.light, 1, 1e-9);
    EXPECT_NEAR(size.deviation, double(inputs.scene.extent.deviation), 1e-5);
    EXPECT_EQ(size.cut, 0);
    EXPECT_NEAR(view.light().lightDepth(), inputs.scene.medium_sample.even()[0].depth / 2, 1e-9);
}

// Errors that are independent of each other average out where many particles overlap.
TEST(SeenLight, PartsOfManyAreSmall) {
    const auto partsOf = [](uint32_t count) {
        const Scene scene = cube(count);
        const PlanInputs inputs = inputsOf(scene);
        double sum = 0;
        const ViewWork view(inputs.scene, inputs.views[0]);
        for (const SeenLight::Size& size : view.light().sizes()) sum += size.part;
        return sum;
    };
    EXPECT_LT(partsOf(500), 0.3);
    EXPECT_GT(partsOf(20), partsOf(500));
}

TEST(SeenLight, TheExtinctionOfLoneParticlesIsTheirOwnAndOverlapAdds) {
    const auto meanOf = [](uint32_t count) {
        const Scene scene = cube(count);
        const PlanScene plan = planScene(scene, Simulation(scene));
        double sum = 0;
        for (const SampledParticle& p : plan.medium_sample.even()) sum += p.extinction;
        return sum / double(plan.medium_sample.even().size());
    };
    Scene scene = cube(1);
    const Simulation one(scene);
    std::vector<gpu::Particle> particles(1);
    one.write(particles);
    const double own = meanOf(1);
    EXPECT_NEAR(own, double(particles[0].sigma_t), 1e-4);
    EXPECT_NEAR((meanOf(2000) - own) / (meanOf(200) - own), 10, 2.5); // all but the first term grows tenfold
}

// A picture that shows few of the medium's particles is judged by those.
TEST(MediumSample, OfWhatAPictureShowsStandsForAllOfThat) {
    const Scene scene = cube(5000, 3);
    const Simulation simulation(scene);
    const PlanScene plan = planScene(scene, simulation);
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    for (const glm::dvec3 middle : {glm::dvec3(3), glm::dvec3(-3, 2, 1), glm::dvec3(0, -4, 2)}) {
        const auto isShown = [&](glm::dvec3 centre, double) { return glm::distance(centre, middle) < 2.5 ? 1.0 : 0.0; };
        const auto shown = std::ranges::count_if(particles, [&](const auto& p) { return isShown(p.centre, 0) > 0; });
        ASSERT_GT(shown, 24);
        double stood_for = 0;
        for (const SampledParticle& p : plan.medium_sample.seenIn(isShown))
            if (isShown(p.centre, 0) > 0) stood_for += p.weight;
        EXPECT_NEAR(stood_for, double(shown), 0.3 * double(shown)) << "up to 24 stand for themselves besides";
    }
}

TEST(ViewWork, OfTheSampleStandsForAllParticles) {
    const Scene scene = cube(5000, 3);
    PlanInputs inputs = inputsOf(scene);
    ASSERT_LT(inputs.scene.sample.size(), 300u);
    const RenderSettings way = makePlan(inputs, builtInCosts()).chosen.settings;
    const Work some = ViewWork(inputs.scene, inputs.views[0]).of(way);
    PlanScene whole = inputs.scene;
    whole.sample.resize(5000);
    Simulation(scene).write(whole.sample);
    const Work all = ViewWork(whole, inputs.views[0]).of(way);
    for (const CostInfo* cost : allCosts()) // 1/sqrt(256) of a spread that is no wider than the mean
        EXPECT_NEAR(some[*cost], all[*cost], 0.1 * all[*cost]) << cost->key;
}

} // namespace
} // namespace brume
