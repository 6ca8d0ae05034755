// The reference in media whose extinction differs among red, green and blue, against closed forms.
#include <cmath>

#include <gtest/gtest.h>

#include "tools/reference/medium_reference.h"
#include "tools/reference/tracker.h"

namespace brume::reference {
namespace {

constexpr double kSigma = 0.7, kHigh = 3, kAlbedo = 0.8, kGround = 0.4, kIrradiance = 5;
const glm::dvec3 kColour{0.25, 1, 0};

// A layer of fog over the ground, lit from straight above.
World layer() {
    World world;
    world.lights = {{.colour = glm::dvec3(kIrradiance)}};
    world.fogs = {{.sigma_t = kSigma, .albedo = glm::dvec3(kAlbedo), .lo = 0, .hi = kHigh}};
    world.fogs[0].extinction_colour = kColour;
    world.obstacles = {{.kind = Obstacle::Kind::plane, .albedo = glm::dvec3(kGround)}};
    return world;
}
const Ray kDown{{0, 10, 0}, {0, -1, 0}};

TEST(ExtinctionColour, ALayerSeenFromAbove) {
    const RayResult seen = along(layer(), kDown);
    glm::dvec3 through(0);
    for (int c = 0; c < 3; ++c) {
        const double depth = kSigma * kColour[c] * kHigh;
        through[c] = std::exp(-depth);
        const double scattered = kAlbedo * kIrradiance / (4 * kPi) * -std::expm1(-2 * depth) / 2;
        const double ground = kGround / kPi * kIrradiance * through[c] * through[c];
        EXPECT_NEAR(seen.scattered[c], scattered, 1e-7) << c;
        EXPECT_NEAR(seen.total()[c], scattered + ground, 1e-7) << c;
    }
    EXPECT_NEAR(seen.transmittance, (through.x + through.y + through.z) / 3, 1e-9);
}

// A Gaussian before the sky: e^-(colour * depth), which particles and fogs have each of their own.
TEST(ExtinctionColour, AParticleAndAFog) {
    World world;
    world.sky_zenith = world.sky_horizon = glm::dvec3(2);
    const gpu::Particle particle{.centre = {0, 0, -20}, .scale = 1, .albedo = glm::vec3(0.5f), .sigma_t = 3};
    world.blobs = blobsOf({&particle, 1}, 1.6);
    world.extinction_colour = {1, 0.5, 0};
    world.fogs = {{.sigma_t = 0.1, .centre = {0, 0, -5}, .radius = 2}};
    world.fogs[0].extinction_colour = {0, 1, 0.5};
    const RayResult seen = along(world, {{0, 0, 0}, {0, 0, -1}});
    const double particles = 3 * std::sqrt(kPi / 50) * 1.6, fog = 0.1 * 4;
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(seen.total()[c],
                    2 * std::exp(-world.extinction_colour[c] * particles - world.fogs[0].extinction_colour[c] * fog),
                    1e-6)
            << c;
}

TEST(ExtinctionColour, OpaqueInAllChannelsHidesTheBackground) {
    World world = layer();
    world.fogs[0].sigma_t = 1e6;
    world.fogs[0].extinction_colour = {1, 0.5, 0.1};
    const RayResult seen = along(world, kDown);
    EXPECT_EQ(seen.transmittance, 0);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(seen.total()[c], kAlbedo * kIrradiance / (8 * kPi), 1e-6) << c;
}

TEST(ExtinctionColour, PathsAreOfOneChannel) {
    const Camera camera = perspective(brume::lookAt({0, 10, 0}, {0.1f, 0, 0}, 0.7f), 2, 2);
    EXPECT_THROW(track(layer(), camera), std::invalid_argument);
    EXPECT_TRUE(isColoured(layer()));
    EXPECT_FALSE(isColoured(inChannel(layer(), 0)));
    EXPECT_NO_THROW(track(inChannel(layer(), 0), camera, {.samples = 2}));
}

} // namespace
} // namespace brume::reference
