// The sky's light in the medium: its low orders against integrals over all directions, the tick that has it, and what
// scenes and commands may not ask of it.
#include "server/inputs/own_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "server/inputs/objects.h"
#include "server/inputs/tick_block.h"
#include "shaders/shared/sky.h"
#include "tests/unit/scene_file.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::own_light_test {
namespace {

using test::errorOf, test::written;
using Axes = std::array<glm::vec3, 3>;

constexpr double kPi = 3.14159265358979323846;

Sky skyOf(glm::vec3 zenith, glm::vec3 horizon) {
    Sky sky;
    sky.zenith = zenith, sky.horizon = horizon;
    return sky;
}

// f of all directions, in steps of equal solid angle.
template <class F>
void forAllDirections(const F& f) {
    constexpr int kHeights = 2000, kTurns = 64;
    for (int i = 0; i < kHeights; ++i)
        for (int j = 0; j < kTurns; ++j) {
            const double y = 2 * (i + 0.5) / kHeights - 1, turn = 2 * kPi * (j + 0.5) / kTurns;
            const double across = std::sqrt(1 - y * y);
            f(glm::dvec3(across * std::cos(turn), y, across * std::sin(turn)), 4 * kPi / (kHeights * kTurns));
        }
}

TEST(OwnLight, LowOrdersOfTheSkyAreItsIntegrals) {
    const glm::dvec3 zenith(0.06, 0.14, 0.9), horizon(0.26, 0.34, 0.46), ground(0.02, 0.2, 0.3);
    const Sky sky = skyOf(zenith, horizon);
    for (const bool has_ground : {false, true}) {
        glm::dvec3 fluence(0), flux(0);
        forAllDirections([&](glm::dvec3 w, double solid_angle) {
            const glm::dvec3 seen =
                has_ground && w.y < 0 ? ground : glm::mix(horizon, zenith, physics::skyZenithPart(w.y));
            fluence += solid_angle * seen, flux += solid_angle * w.y * seen;
        });
        const OuterLight light = outerLight(sky, has_ground ? std::optional(ground) : std::nullopt);
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(4 * kPi * light.mean[c], fluence[c], 1e-5) << has_ground << ' ' << c;
            EXPECT_NEAR(4 * kPi / 3 * light.up[c], flux[c], 1e-5) << has_ground << ' ' << c;
        }
    }
}

// Also where a sky of the first order would be negative: over black ground.
TEST(OwnLight, NothingThatEntersIsNegative) {
    const OuterLight light = outerLight(skyOf(glm::vec3(1), glm::vec3(0)), glm::dvec3(0));
    EXPECT_EQ(light.up, light.mean);
    EXPECT_NEAR(light.mean.x, 0.5 * 0.646878, 1e-6);
}

TEST(OwnLight, FluxesHaveTheFluenceAndTheNetFluxAlongAnyAxes) {
    const OuterLight light = outerLight(skyOf({0.1f, 0.2f, 0.3f}, {0.3f, 0.3f, 0.2f}), {});
    for (const glm::vec3 toward : {glm::vec3(0, 1, 0), glm::normalize(glm::vec3(0.8f, 0.55f, 0.15f))}) {
        gpu::Tick tick{};
        setSun(tick, toward);
        const Axes axes{tick.map.x, tick.map.y, -toward};
        const EnteringFluxes entering = enteringFluxes(light, axes);
        glm::dvec3 fluence(0);
        glm::dmat3 flux(0); // of each colour
        for (size_t axis = 0; axis < 3; ++axis) {
            const glm::dvec3 up = entering.mean + entering.up[axis], down = entering.mean - entering.up[axis];
            fluence += up + down;
            for (int c = 0; c < 3; ++c) flux[c] += (up - down)[c] * glm::dvec3(axes[axis]);
        }
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(fluence[c], 4 * kPi * light.mean[c], 1e-6);
            EXPECT_NEAR(flux[c].y, -4 * kPi / 3 * light.up[c], 1e-6) << "light of above goes down";
            EXPECT_NEAR(flux[c].x, 0, 1e-6);
            EXPECT_NEAR(flux[c].z, 0, 1e-6);
        }
    }
}

Scene skyLit() {
    Scene scene = cubeScene(10);
    scene.render.scattering = "propagation";
    scene.sky.lights = true;
    return scene;
}

gpu::Multiple multipleOf(const Scene& scene) {
    const std::vector<gpu::Particle> particles(1, {.scale = 1, .albedo = glm::vec3(0.9f), .sigma_t = 1});
    return makeTick(scene, {scene.medium, sunOf(scene), listsOf(scene), scene.render, scene.simulation}, particles,
                    opaqueObjects(scene))
        .multiple;
}

// Without own light the fluxes are for an irradiance of 1, and nothing enters.
TEST(OwnLight, TheTickSaysWhatFluxesAreMultipliedBy) {
    Scene scene = skyLit();
    const glm::vec3 sun = {3, 2, 1};
    scene.lights[0].irradiance = sun;
    const gpu::Multiple lit = multipleOf(scene);
    EXPECT_EQ(lit.own, 1u);
    EXPECT_EQ(lit.sun, sun);
    EXPECT_EQ(lit.irradiance, glm::vec3(1));
    EXPECT_GT(lit.entering.x, 0);
    scene.sky.lights = false;
    const gpu::Multiple not_lit = multipleOf(scene);
    EXPECT_EQ(not_lit.own, 0u);
    EXPECT_EQ(not_lit.sun, glm::vec3(1));
    EXPECT_EQ(not_lit.irradiance, sun);
    EXPECT_EQ(not_lit.entering, glm::vec3(0));
    for (const glm::vec3 up : not_lit.entering_up) EXPECT_EQ(up, glm::vec3(0));
}

TEST(OwnLight, HasOneChannelIfAllIsGrey) {
    Scene scene = skyLit();
    scene.lights[0].irradiance = glm::vec3(2);
    scene.sky.zenith = glm::vec3(0.5f), scene.sky.horizon = glm::vec3(1);
    EXPECT_EQ(multipleOf(scene).channels, 1u);
    scene.sky.zenith.z = 0.6f;
    EXPECT_EQ(multipleOf(scene).channels, 3u);
    scene.sky.zenith.z = 0.5f, scene.lights[0].irradiance.x = 3;
    EXPECT_EQ(multipleOf(scene).channels, 3u);
    scene.sky.lights = false;
    EXPECT_EQ(multipleOf(scene).channels, 1u);
}

// The highest plane counts, and a ground that reflects nothing where surfaces send no light.
TEST(OwnLight, AGroundSendsWhatItGetsOfTheSky) {
    Scene scene = skyLit();
    scene.sky.zenith = scene.sky.horizon = glm::vec3(1);
    scene.planes = {{.height = -9, .albedo = glm::vec3(0)}, {.height = -6, .albedo = glm::vec3(1)}};
    const float all = float(4 * kPi / 6);
    EXPECT_NEAR(multipleOf(scene).entering.x, all, 1e-6f);
    for (const glm::vec3 up : multipleOf(scene).entering_up) EXPECT_NEAR(up.x, 0, 1e-6f);
    scene.planes[1].albedo = glm::vec3(0.5f);
    EXPECT_NEAR(multipleOf(scene).entering.x, 0.75f * all, 1e-6f);
    scene.render.propagation.surface_parts = 0;
    EXPECT_NEAR(multipleOf(scene).entering.x, 0.5f * all, 1e-6f);
}

TEST(OwnLight, ScenesThatCannotHaveItSaySo) {
    const std::string lights = "[sky]\nlights = true\n", propagation = "[render]\nscattering = \"propagation\"\n";
    EXPECT_TRUE(loadScene(written(lights + propagation)).sky.lights);
    EXPECT_FALSE(loadScene(written(propagation)).sky.lights);
    EXPECT_EQ(errorOf(lights), "sky.lights: true with render.scattering = \"single\"; set it to \"propagation\", or "
                               "sky.ambient in its place");
    EXPECT_NE(errorOf(lights + "[render]\nscattering = \"octaves\"\n").find("with render.scattering = \"octaves\""),
              std::string::npos);
    EXPECT_NE(errorOf("[medium]\nmodel = \"union\"\n" + lights).find("in which light scatters once"),
              std::string::npos);
    EXPECT_NE(errorOf("[medium]\nlayout = \"none\"\n" + lights + propagation).find("without particles"),
              std::string::npos);
}

TEST(OwnLight, CommandsDoNotTurnItsScatteringOff) {
    Simulation simulation(skyLit());
    for (const char* other : {"single", "octaves"}) {
        give(simulation, {command(Set{{"medium.falloff", 1.5f}, {"render.scattering", std::string(other)}})});
        ASSERT_EQ(simulation.refused().size(), 1u);
        EXPECT_EQ(simulation.refused()[0].why,
                  "the sky lights this scene's medium, for which render.scattering stays \"propagation\"");
        EXPECT_EQ(simulation.now().render.scattering, "propagation");
        EXPECT_NE(simulation.now().medium.falloff, 1.5f) << "all changes, or none";
    }
    give(simulation, {command(Set{{"render.scattering", std::string("propagation")}})});
    EXPECT_TRUE(simulation.refused().empty());
    Scene not_lit = skyLit();
    not_lit.sky.lights = false;
    Simulation other(not_lit);
    give(other, {command(Set{{"render.scattering", std::string("single")}})});
    EXPECT_EQ(other.now().render.scattering, "single");
}

} // namespace
} // namespace brume::own_light_test
