// Random paths against exact answers, each within its own interval: 4 standard errors, which a right program leaves
// once in 16000.
#include "tools/reference/tracker.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/reference/test_media.h"
#include "tools/reference/medium_reference.h"

namespace {

using namespace brume::reference;
using namespace brume::reference::test;

void expectWithin(const char* what, double got, double error, double exact) {
    std::printf("%-50s %.7g +- %.1e (1 standard error), exact %.7g\n", what, got, error, exact);
    EXPECT_NEAR(got, exact, 4 * error + 1e-12 * std::abs(exact)) << what;
}

// One pixel that looks straight down from above.
Camera downward() { return orthographic(brume::lookAt({0, 20, 0.0001f}, {0, 0, 0}, 1), 1, 1, 1); }

TEST(Tracker, HalfSpaceUnderNormalIncidence) {
    World world;
    Fog fog{1.3, glm::dvec3(0.9)};
    fog.hi = 0;
    world.fogs = {fog};
    world.lights = {distant({0, 1, 0})};
    TrackSettings settings;
    settings.samples = 400'000;
    const TrackedPicture picture = track(world, downward(), settings);
    expectWithin("half-space, albedo 0.9", picture.radiance[0].x, picture.standard_error[0].x, 0.1225723);
    EXPECT_LT(picture.standard_error[0].x, 3e-3 * 0.1225723);
}

TEST(Tracker, WhiteFurnace) {
    World world;
    world.blobs = cloud(40, 6, 5, 1.5, glm::dvec3(1));
    world.balls = {{{{0, 0, 0}, 1}, {{0.5, 0, 0}, 1}}, 0.7, glm::dvec3(1)};
    world.fogs = {{0.05, glm::dvec3(1), 0.2}};
    world.fogs[0].lo = -6;
    world.phase = {0.8, 0.6};
    world.ambient = world.sky_horizon = world.sky_zenith = glm::dvec3(1, 2, 3);
    TrackSettings settings;
    settings.samples = 20;
    const TrackedPicture picture =
        track(world, perspective(brume::lookAt({1, 2, 12}, {0, 0, 0}, 0.7f), 16, 9), settings);
    for (size_t i = 0; i < picture.radiance.size(); ++i)
        for (int c = 0; c < 3; ++c) // no path gains or loses: not even noise
            ASSERT_NEAR(picture.radiance[i][c], 1 + c, 1e-12) << i;
}

// What is as hot as all around it is as bright, whatever it scatters (Kirchhoff 1860).
TEST(Tracker, AnEvenTemperatureHidesTheMedium) {
    World world;
    world.blobs = cloud(40, 6, 5, 1.5, {0.2, 0.5, 0.9});
    world.ambient = world.sky_horizon = world.sky_zenith = world.emission = glm::dvec3(1, 2, 3);
    TrackSettings settings;
    settings.samples = 20'000;
    const TrackedPicture picture =
        track(world, perspective(brume::lookAt({1, 2, 12}, {0, 0, 0}, 0.7f), 8, 5), settings);
    for (size_t i = 0; i < picture.radiance.size(); ++i)
        for (int c = 0; c < 3; ++c)
            ASSERT_NEAR(picture.radiance[i][c], 1 + c, 5 * picture.standard_error[i][c] + 1e-12) << i;
}

// The sky itself in place of ambient light: it is seen behind, and lights what scatters where that is asked for.
TEST(Tracker, TheSkyIsAFurnaceWhereItLights) {
    World world;
    world.blobs = cloud(40, 6, 5, 1.5, glm::dvec3(1));
    world.fogs = {{0.05, glm::dvec3(1), 0.2}};
    world.fogs[0].lo = -6;
    world.phase = {0.8, 0.6};
    world.sky_horizon = world.sky_zenith = glm::dvec3(1, 2, 3);
    world.sky_lights = true;
    TrackSettings settings;
    settings.samples = 20;
    const Camera camera = perspective(brume::lookAt({1, 2, 12}, {0, 0, 0}, 0.7f), 16, 9);
    const TrackedPicture picture = track(world, camera, settings);
    for (size_t i = 0; i < picture.radiance.size(); ++i)
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(picture.radiance[i][c], 1 + c, 1e-12) << i;
    world.sky_lights = false;
    EXPECT_LT(track(world, camera, settings).radiance[5 * 16 + 8].x, 0.5);
}

// A thin medium gets the sky's mean over the phase function: here of all directions.
TEST(Tracker, AThinMediumScattersTheMeanOfTheSky) {
    World world;
    world.blobs = {blob({0, 0, 0}, 2, 1.6, 0.01, glm::dvec3(1))};
    world.sky_horizon = glm::dvec3(1), world.sky_zenith = glm::dvec3(3);
    world.sky_lights = true;
    TrackSettings settings;
    settings.samples = 1'000'000;
    const TrackedPicture lit = track(world, downward(), settings);
    world.sky_lights = false;
    const TrackedPicture dimmed = track(world, downward(), settings); // of the sky below, of radiance 1
    const double scattered = 1 - dimmed.radiance[0].x, error = lit.standard_error[0].x / scattered;
    expectWithin("light of a thin medium", (lit.radiance[0].x - dimmed.radiance[0].x) / scattered, error,
                 1 + 2 * 0.325);
    EXPECT_LT(error, 0.02);
}

// Half of the energy absorbed at each event, light from everywhere: a lossy furnace is darker, by the optically thin
// limit rho tau.
TEST(Tracker, ThinMediumLosesWhatItAbsorbs) {
    World world;
    world.blobs = {blob({0, 0, 0}, 2, 1.6, 0.01, glm::dvec3(0.5))};
    world.ambient = world.sky_horizon = world.sky_zenith = glm::dvec3(1);
    TrackSettings settings;
    settings.samples = 300'000;
    const TrackedPicture picture = track(world, downward(), settings);
    // 1 - tau (1 - rho), and of second order: at most tau^2.
    EXPECT_NEAR(picture.radiance[0].x, 1 - 0.005, 4 * picture.standard_error[0].x + 1e-4);
    EXPECT_GT(picture.standard_error[0].x, 0);
}

// Paths that scatter downward end on the ground, which is equally bright all over; the others end in a dark sky.
TEST(Tracker, DirectionsFollowThePhaseFunction) {
    for (const brume::PhaseLobes& lobes : {brume::PhaseLobes{1, 0.3, 22, 0}, {0, 0, 0, 0.6}, {1, 0, 1, 0}}) {
        World world;
        world.blobs = {blob({0, 0, 0}, 2, 1.6, 0.01, glm::dvec3(1))};
        world.obstacles = {{Obstacle::Kind::plane, {0, -30, 0}, glm::dvec3(0), 0, glm::dvec3(1)}};
        const glm::dvec3 to_light =
            glm::normalize(glm::dvec3(1, 1, 0)); // the ground under the blob is not in its shade
        world.lights = {distant(to_light)};
        world.phase = lobes;
        TrackSettings settings;
        settings.samples = 1'000'000;
        settings.orders = 1;
        const double all = track(world, downward(), settings).radiance[0].x;
        settings.orders = 0;
        const double straight = track(world, downward(), settings).radiance[0].x;
        World bare = world;
        bare.blobs.clear();
        settings.samples = 1;
        const double ground = track(bare, downward(), settings).radiance[0].x;
        const double single = phase(world.phase, -to_light, {0, 1, 0}); // from the sun to the eye
        double downward_part = 0;
        const int n = 2000;
        for (int i = 0; i < n; ++i) {
            const double cosine = (i + 0.5) / n, sine = std::sqrt(1 - cosine * cosine);
            downward_part += 2 * kPi / n * phase(world.phase, {0, -1, 0}, {sine, -cosine, 0});
        }
        const double scattered = 1 - straight / ground; // the part of paths that collide
        EXPECT_NEAR((all - straight) / scattered, single + downward_part * ground, 0.02 * ground)
            << lobes.draine << ' ' << lobes.second;
    }
}

// The first order by paths is single scattering by closed forms, pixel by pixel, with every kind of light, medium and
// object.
TEST(Tracker, FirstOrderIsSingleScattering) {
    World world;
    world.blobs = cloud(12, 5, 4, 0.6, {0.9, 0.8, 0.7});
    world.balls = {{{{-2, 0, 0}, 1}, {{-1.2, 0.3, 0}, 1}}, 0.4, glm::dvec3(0.6)};
    world.fogs = {{0.03, glm::dvec3(0.8), 0.1}};
    world.phase = {0.6, 0.5};
    world.sky_horizon = {0.1, 0.2, 0.3};
    world.obstacles = {{Obstacle::Kind::plane, {0, -3, 0}, glm::dvec3(0), 0, glm::dvec3(0)},
                       {Obstacle::Kind::box,
                        {0.5, 3, 0},
                        {1, 0.4, 1.5},
                        0.5,
                        glm::dvec3(0)}}; // black: paths see the light of surfaces, too
    LightSource point;
    point.kind = LightSource::Kind::point;
    point.position = {2, 7, 3};
    point.colour = glm::dvec3(60);
    world.lights = {distant({0.5, 1, 0.2}, 3), point};
    const Camera camera = perspective(brume::lookAt({-4, 2, 12}, {0, 0, 0}, 0.7f), 8, 5);
    TrackSettings settings;
    settings.samples = 20'000;
    settings.orders = 1;
    const TrackedPicture paths = track(world, camera, settings);
    const std::vector<glm::dvec3> exact = render(world, camera).total();
    double worst = 0, squares = 0, noise = 0;
    for (size_t i = 0; i < exact.size(); ++i) {
        ASSERT_GT(paths.standard_error[i].x, 0);
        const glm::dvec3 off = (paths.radiance[i] - exact[i]) / paths.standard_error[i];
        worst = std::max(worst, std::abs(off.x));
        squares += off.x * off.x;
        noise = std::max(noise, paths.standard_error[i].x / exact[i].x);
    }
    const double pixels = static_cast<double>(exact.size());
    std::printf(
        "first order: %g pixels off by at most %.2f standard errors (RMS %.2f), which are at most %.1e of the pixel\n",
        pixels, worst, std::sqrt(squares / pixels), noise);
    EXPECT_LT(worst, 4.5);                                       // of 40 normal numbers: once in 3700
    EXPECT_NEAR(squares / pixels, 1, 5 * std::sqrt(2 / pixels)); // mean of 40 squares; a wrong interval would miss it
    EXPECT_LT(noise, 0.02);
}

TEST(Tracker, MoreOrdersAreBrighterAndSeedsRepeat) {
    World world;
    world.blobs = cloud(12, 3, 4, 1.5, glm::dvec3(0.95));
    world.lights = {distant({0.5, 1, 0.2}, 3)};
    const Camera camera = perspective(brume::lookAt({0, 0, 12}, {0, 0, 0}, 0.4f), 4, 3);
    TrackSettings settings;
    settings.samples = 2000;
    settings.threads = 1;
    const TrackedPicture all = track(world, camera, settings);
    settings.threads = 3;
    EXPECT_EQ(track(world, camera, settings).radiance, all.radiance);
    settings.orders = 1;
    const TrackedPicture one = track(world, camera, settings);
    double more = 0, variance = 0;
    for (size_t i = 0; i < all.radiance.size(); ++i) {
        more += all.radiance[i].x - one.radiance[i].x;
        variance +=
            all.standard_error[i].x * all.standard_error[i].x + one.standard_error[i].x * one.standard_error[i].x;
    }
    EXPECT_GT(more, 4 * std::sqrt(variance));
    settings.orders = 1'000'000;
    settings.seed = 2;
    EXPECT_NE(track(world, camera, settings).radiance, all.radiance);
}

TEST(Tracker, RefusesWhatIsNotTheTrueMedium) {
    World world;
    world.support = Support::tetrahedron;
    EXPECT_THROW(track(world, downward()), std::invalid_argument);
    world.support = Support::full;
    world.composition = Composition::sequential;
    EXPECT_THROW(track(world, downward()), std::invalid_argument);
    world.fogs = {{0.1}};
    EXPECT_THROW(render(world, downward()), std::invalid_argument);
}

} // namespace
