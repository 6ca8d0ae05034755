// What viewers draw by themselves (common/lit_medium.h) beside the reference: exact fits, so that the slabs and the
// fits are what errs.
#include <gtest/gtest.h>

#include "common/lit_medium.h"
#include "shaders/shared/particle_fit.h"
#include "tests/reference/test_media.h"
#include "tools/reference/medium_reference.h"

namespace brume::reference {
namespace {

// Fits as shaders/lit_particles.comp makes them, of exact light.
lit::Medium litMediumOf(const World& world) {
    const LightSource& sun = world.lights.front();
    const glm::dvec3 to_light = sun.to_light;
    const auto arriving = [&](glm::dvec3 x) {
        double depth = 0;
        for (const Blob& b : world.blobs) {
            const glm::dvec3 r = x - b.centre;
            const double along = glm::dot(r, to_light), b2 = glm::dot(r, r) - along * along;
            depth += b.half_line * std::exp(-b.k * b.k * b2) * std::erfc(b.k * along);
        }
        return std::exp(-depth);
    };
    lit::Medium medium;
    medium.to_light = to_light, medium.irradiance = sun.colour, medium.ambient = world.ambient;
    medium.emission = world.emission, medium.cold_albedo = world.cold_albedo;
    medium.phase = {world.phase.part, world.phase.asymmetry, world.phase.draine, world.phase.second};
    for (const Blob& b : world.blobs) {
        lit::Medium::Particle p{b.centre, b.scale, b.k, b.sigma_t, b.albedo};
        auto& fit = p.fits[0];
        const auto reach = double(gpu::kFitReach);
        fit.middle = arriving(b.centre);
        for (int j = 0; j < 3; ++j) {
            glm::dvec3 axis(0), same(0), other(0);
            axis[j] = reach / b.k;
            fit.slope[j] = (arriving(b.centre + axis) - arriving(b.centre - axis)) / (2 * reach);
            fit.bend[j] =
                (0.5 * (arriving(b.centre + axis) + arriving(b.centre - axis)) - fit.middle) / (reach * reach);
            same[(j + 1) % 3] = same[(j + 2) % 3] = other[(j + 1) % 3] = std::sqrt(0.5) * reach / b.k;
            other[(j + 2) % 3] = -same[(j + 2) % 3];
            fit.twist[j] = (arriving(b.centre + same) + arriving(b.centre - same) - arriving(b.centre + other) -
                            arriving(b.centre - other)) /
                           (4 * reach * reach);
        }
        medium.particles.push_back(p);
    }
    return medium;
}

World cloudOf(int count, double scale, double depth) {
    World world;
    world.blobs = test::cloud(count, 8, scale, depth, {0.9, 0.8, 0.7});
    world.lights.push_back({.colour = {10, 9, 8}, .to_light = glm::normalize(glm::dvec3(0.8, 0.55, 0.15))});
    return world;
}

double errorOf(const World& world, const Pose& pose, uint32_t slabs = lit::kSlabs) {
    const Camera camera = perspective(pose, 32, 18, 0.05);
    const lit::Medium medium = litMediumOf(world);
    const Picture truth = render(world, camera, {.tolerance = 1e-6});
    std::vector<glm::dvec3> drawn;
    for (int y = 0; y < 18; ++y)
        for (int x = 0; x < 32; ++x) {
            const Ray ray = rayThrough(camera, x + 0.5, y + 0.5);
            drawn.push_back(lit::along(medium, ray.origin, ray.direction, ray.begin, 1e9, slabs).radiance);
        }
    return relativeRmse(drawn, truth.radiance);
}

TEST(LitMedium, IsNearTheReference) {
    const World world = cloudOf(300, 6, 0.1);
    EXPECT_LT(errorOf(world, lookAt({0, 2, 22}, {0, 0, 0}, 0.6f)), 0.02) << "from outside";
    EXPECT_LT(errorOf(world, lookAt({0.5f, 0, 0.3f}, {9, 0, 3}, 1)), 0.025) << "from inside";
    World lobe = world;
    lobe.phase = {0.7, 0.6, 0, 0};
    lobe.ambient = {0.1, 0.2, 0.3};
    EXPECT_LT(errorOf(lobe, lookAt({-15, 2, 12}, {0, 0, 0}, 0.6f)), 0.02) << "with a lobe and ambient light";
    World soot = world;
    for (size_t i = 0; i < soot.blobs.size(); ++i) soot.blobs[i].albedo *= double(i % 3) / 2;
    soot.emission = {12, 4, 1};
    soot.cold_albedo = {0.9, 0.8, 0.7};
    EXPECT_LT(errorOf(soot, lookAt({0, 2, 22}, {0, 0, 0}, 0.6f)), 0.02) << "with glowing soot";
}

// One particle alone: nothing overlaps, so the fit to its own shadow is what errs, in proportion to its depth.
TEST(LitMedium, AParticleErrsByTheFitToItsShadow) {
    for (const double depth : {0.01, 0.05, 0.2}) {
        World world;
        world.blobs = {test::blob({0, 0, 0}, 6, 1.6, depth)};
        world.lights.push_back({.colour = {10, 9, 8}, .to_light = {0, 1, 0}});
        const Pose pose = lookAt({0, 0, 8}, {0, 0, 0}, 0.8f);
        EXPECT_LT(errorOf(world, pose, 64), 0.07 * depth) << depth;
        EXPECT_LT(errorOf(world, pose), 0.07 * depth) << depth;
    }
}

// Dense media are where slabs err: it says so, and stays finite.
TEST(LitMedium, MoreSlabsErrLess) {
    const World world = cloudOf(120, 5, 1.5);
    const Pose pose = lookAt({0, 2, 22}, {0, 0, 0}, 0.6f);
    const double eight = errorOf(world, pose), many = errorOf(world, pose, 64);
    EXPECT_LT(many, eight + 0.002);
    EXPECT_LT(eight, 0.15);
}

// A ray that ends at a surface has the part of the medium before it.
TEST(LitMedium, SurfacesCutTheRay) {
    const World world = cloudOf(300, 6, 0.1);
    const lit::Medium medium = litMediumOf(world);
    const glm::dvec3 from(0, 0, 20), way(0, 0, -1);
    const lit::Seen all = lit::along(medium, from, way, 0.05, 1e9);
    const RayResult whole = along(world, {from, way, 0.05, 1e9}, {.tolerance = 1e-6});
    double before = 1;
    for (const double far : {10.0, 15.0, 18.0, 20.0, 22.0, 40.0}) {
        const RayResult truth = along(world, {from, way, 0.05, far}, {.tolerance = 1e-6});
        const lit::Seen seen = lit::along(medium, from, way, 0.05, far);
        EXPECT_NEAR(seen.transmittance.x, truth.transmittance, 0.01) << far;
        EXPECT_NEAR(seen.radiance.x / all.radiance.x, truth.scattered.x / whole.scattered.x, 0.02) << far;
        EXPECT_LE(seen.transmittance.x, before + 1e-9);
        before = seen.transmittance.x;
    }
}

} // namespace
} // namespace brume::reference
