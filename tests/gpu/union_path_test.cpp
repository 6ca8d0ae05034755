// Light behind the union of balls, one value for each particle: against double precision, with the thesis's cut-off,
// and in groups that take turns.
#include "server/effects/union_path/union_path.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/opaque/object_buffers.h"
#include "shaders/shared/splat.h"
#include "tests/gpu/light_passes.h"
#include "tools/reference/geometry.h"
#include "tools/reference/world.h"

namespace brume::test::union_path_test {
namespace {

const glm::vec3 kFromAbove(0, 1, 0), kFromTheRight(1, 0, 0);

Scene tubes(uint32_t count, glm::vec3 to_light) {
    Scene scene;
    scene.medium.model = kUnionMedium;
    scene.medium.layout = Layout::tubes;
    scene.medium.count = count;
    scene.medium.scale = {3, 3};
    scene.medium.union_radius = 0.12f * std::cbrt(750.0f / float(count)); // the same volume of balls
    scene.lights = {{.to_light = to_light}};
    return scene;
}

// What the device computes at the simulation's present tick.
std::vector<gpu::ParticleLight> lightOf(const gpu::Device& device, const Scene& scene, const Simulation& simulation,
                                        UnionPath& path) {
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    const SceneNow& now = simulation.now();
    const gpu::Tick tick = makeTick(scene, now, particles, {});
    const ObjectBuffers objects(device, scene);
    path.prepare(simulation, now, tick, simulation.tick(), 0);
    const auto count = uint32_t(particles.size());
    const gpu::Buffer back(device, count * sizeof(gpu::ParticleLight), VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                           gpu::Memory::readback, "light readback");
    recordAndWait(device, tick, "Particles", particles, [&](gpu::Commands& commands, gpu::Resources& shared) {
        shared.give(gpu::storageBuffer("Objects", objects.objects()));
        shared.give(gpu::storageBuffer("ObjectNodes", objects.nodes()));
        path.record(commands, {.resources = shared, .count = count});
        gpu::computeToTransfer(commands.handle());
        const VkBufferCopy copy{0, 0, back.size()};
        vkCmdCopyBuffer(commands.handle(), path.lights().handle(), back.handle(), 1, &copy);
        gpu::transferToHost(commands.handle());
    });
    back.invalidate();
    const auto mapped = back.mapped<gpu::ParticleLight>(count);
    return {mapped.begin(), mapped.end()};
}

struct Truth {
    double path = 0; // m
    uint32_t hits = 0;
};
std::vector<Truth> truthOf(const Scene& scene, const Simulation& simulation) {
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    const reference::UnionMedium medium =
        reference::unionOf(particles, double(scene.medium.union_radius), 1, glm::dvec3(1));
    std::vector<Truth> all;
    std::vector<reference::Interval> parts;
    for (const gpu::Particle& p : particles) {
        const reference::Ray toward{p.centre, glm::normalize(glm::dvec3(simulation.now().light.to_light))};
        Truth& truth = all.emplace_back();
        reference::insideUnion(medium, toward, parts);
        for (const reference::Interval part : parts) truth.path += part.end - part.begin;
        for (const reference::UnionMedium::Ball& ball : medium.balls) {
            const reference::Interval part = reference::insideSphere(ball.centre, ball.radius, toward);
            if (!part.empty() && part.end > 0) truth.hits += part.begin > 0 ? 2 : 1;
        }
    }
    return all;
}

TEST_F(GpuTest, UnionPathIsTheLengthWithinBalls) {
    for (const uint32_t count : {1u, 250u, 750u, 1500u, 8192u})
        for (const glm::vec3 to_light : {kFromAbove, kFromTheRight}) {
            const Scene scene = tubes(count, to_light);
            const Simulation simulation(scene);
            UnionPath path(device());
            const std::vector<gpu::ParticleLight> lights = lightOf(device(), scene, simulation, path);
            const std::vector<Truth> truth = truthOf(scene, simulation);
            double worst = 0;
            for (size_t i = 0; i < truth.size(); ++i) {
                const double got = -std::log(double(lights[i].transmittance)) / double(scene.medium.union_extinction);
                worst = std::max(worst, std::abs(got - truth[i].path) / truth[i].path);
                EXPECT_EQ(lights[i].gradient, glm::vec3(0));
            }
            std::printf("%u balls, light %s: %.1e\n", count, to_light.y > 0 ? "from above" : "from the right", worst);
            EXPECT_LE(worst, 1e-5) << count;
        }
}

// Mattsson's table B.4 and figure 5.6: how much light is lost behind a cut-off.
TEST_F(GpuTest, ParticlesBeyondTheUnionPathsCutoffAreBlack) {
    for (const float extinction : {0.25f, 0.5f}) {
        Scene scene = tubes(750, kFromTheRight);
        scene.medium.union_extinction = extinction;
        double last = 1;
        for (const uint32_t cutoff : {20u, 40u, 60u, 80u}) {
            scene.render.path.cutoff = cutoff;
            const Simulation simulation(scene);
            UnionPath path(device());
            const std::vector<gpu::ParticleLight> lights = lightOf(device(), scene, simulation, path);
            const std::vector<Truth> truth = truthOf(scene, simulation);
            double lost = 0, all = 0;
            for (size_t i = 0; i < truth.size(); ++i) {
                const double light = std::exp(-double(extinction) * truth[i].path);
                all += light;
                if (truth[i].hits >= cutoff) lost += light;
                EXPECT_NEAR(double(lights[i].transmittance), truth[i].hits >= cutoff ? 0 : light, 1e-5) << i;
            }
            std::printf("extinction %.2f, cut-off %u: %.1f %% of the light is lost\n", double(extinction), cutoff,
                        100 * lost / all);
            EXPECT_LE(lost / all, last);
            last = lost / all;
        }
        EXPECT_LT(last, 1e-3);
    }
}

bool sameBits(const std::vector<gpu::ParticleLight>& a, const std::vector<gpu::ParticleLight>& b) {
    return std::ranges::equal(a, b, {}, &gpu::ParticleLight::transmittance, &gpu::ParticleLight::transmittance);
}

TEST_F(GpuTest, UnionPathsOfGroupsFollowFromTheTickAlone) {
    Scene scene = tubes(200, glm::normalize(glm::vec3(0.3f, 0.8f, 0.2f)));
    scene.lights[0].rotate = 0.5f;
    scene.simulation.volume_velocity = {0.3f, 0, 0};
    constexpr uint32_t kGroups = 4;
    scene.render.path.groups = kGroups;
    Simulation simulation(scene);
    UnionPath every_tick(device());
    std::vector<std::vector<gpu::ParticleLight>> whole; // of each tick, all particles
    std::vector<gpu::ParticleLight> lights;
    for (int tick = 0; tick <= 9; ++tick) {
        if (tick > 0) simulation.step({});
        lights = lightOf(device(), scene, simulation, every_tick);
        Scene alone = scene;
        alone.render.path.groups = 1;
        Simulation same(alone);
        for (int i = 0; i < tick; ++i) same.step({});
        UnionPath all(device());
        whole.push_back(lightOf(device(), alone, same, all));
        for (uint32_t i = 0; i < lights.size(); ++i) {
            const int ago = int((uint32_t(tick) % kGroups + kGroups - i % kGroups) % kGroups);
            ASSERT_EQ(lights[i].transmittance, whole[std::max(tick - ago, 0)][i].transmittance) << tick << ' ' << i;
        }
    }
    EXPECT_FALSE(sameBits(lights, whole.back())); // they lag behind
    UnionPath last_tick(device());
    EXPECT_TRUE(sameBits(lights, lightOf(device(), scene, simulation, last_tick)));

    simulation.step(std::vector<Command>{{.body = Set{{"simulation.paused", true}}}});
    std::vector<gpu::ParticleLight> paused;
    for (uint32_t tick = 0; tick < kGroups; ++tick) {
        paused = lightOf(device(), scene, simulation, every_tick);
        simulation.step({});
    }
    Scene alone = scene;
    alone.render.path.groups = 1;
    Simulation same(alone);
    for (int i = 0; i < 9; ++i) same.step({});
    UnionPath all(device());
    EXPECT_TRUE(sameBits(paused, lightOf(device(), alone, same, all)));
}

// Mattsson's figure 5.5: the light turns by 0.5 rad/s.
TEST_F(GpuTest, UnionPathsOfMoreGroupsLagMore) {
    Scene scene = tubes(1024, glm::normalize(glm::vec3(1, 0.3f, 0)));
    scene.lights[0].rotate = 0.5f;
    std::vector<gpu::ParticleLight> present;
    double last = 0;
    for (const uint32_t groups : {1u, 2u, 4u, 8u, 16u, 32u}) {
        scene.render.path.groups = groups;
        Simulation simulation(scene);
        for (int tick = 0; tick < 64; ++tick) simulation.step({});
        UnionPath path(device());
        const std::vector<gpu::ParticleLight> lights = lightOf(device(), scene, simulation, path);
        if (groups == 1) present = lights;
        double errors = 0, squares = 0;
        for (size_t i = 0; i < lights.size(); ++i) {
            errors += std::pow(double(lights[i].transmittance) - double(present[i].transmittance), 2);
            squares += std::pow(double(present[i].transmittance), 2);
        }
        const double error = std::sqrt(errors / squares);
        std::printf("%u groups: %.2f %%\n", groups, 100 * error);
        EXPECT_TRUE(groups == 1 || error > last) << groups;
        EXPECT_LT(error, 0.2);
        last = error;
    }
}

TEST_F(GpuTest, UnionPathsAreRefusedForTooManyParticles) {
    Scene scene = tubes(8192, kFromAbove);
    EXPECT_NO_THROW(Simulation{scene});
    scene.medium.count = 8193;
    EXPECT_THROW(Simulation{scene}, SceneError);
}

} // namespace
} // namespace brume::test::union_path_test
