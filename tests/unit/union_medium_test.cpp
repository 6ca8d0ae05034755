// The medium as the union of balls: what scenes and commands may not ask of it, and the ticks that it remembers.
#include <gtest/gtest.h>

#include "tests/unit/scene_file.h"
#include "tests/unit/simulation_scenes.h"

namespace brume {
namespace {

using test::errorOf, test::written;

constexpr const char* kUnion = "[medium]\nmodel = \"union\"\n";

Scene unionScene(uint32_t count = 10) {
    Scene scene = cubeScene(count);
    scene.medium.model = kUnionMedium;
    return scene;
}

TEST(UnionMedium, ScenesHaveNoFogMeshesOrLampsWithIt) {
    EXPECT_EQ(loadScene(written(kUnion)).medium.model, kUnionMedium);
    EXPECT_TRUE(loadScene(written("fog = []\nmesh = []\n" + std::string(kUnion))).fogs.empty());
    EXPECT_NE(errorOf(std::string(kUnion) + "[[fog]]\n")
                  .find("fog: is not drawn with medium.model = \"union\"; allowed: only with medium.model = \"sum\""),
              std::string::npos);
    EXPECT_NE(errorOf(std::string(kUnion) + "[[light]]\ntype = \"point\"\n")
                  .find("points and spots are not drawn with medium.model = \"union\""),
              std::string::npos);
    EXPECT_NE(
        errorOf(std::string(kUnion) + "[render]\nscattering = \"octaves\"\n").find("a union medium needs \"single\""),
        std::string::npos);
    EXPECT_NE(errorOf("[medium]\nmodel = \"both\"\n").find("sum"), std::string::npos);
    EXPECT_NE(errorOf("[medium]\nunion_radius = 0\n").find("union_radius"), std::string::npos);
}

TEST(UnionMedium, CommandsAddNoneEither) {
    Simulation simulation(unionScene());
    give(simulation, {command(Add{.list = SceneList::fogs})});
    ASSERT_EQ(simulation.refused().size(), 1u);
    EXPECT_NE(simulation.refused()[0].why.find("only with medium.model = \"sum\""), std::string::npos);
    give(simulation, {command(Add{.list = SceneList::lights})});
    EXPECT_EQ(simulation.refused().size(), 1u);
    EXPECT_TRUE(simulation.now().lists.fogs.empty() && simulation.now().lists.lights.empty());
    give(simulation, {command(Set{{"medium.union_extinction", 2.0f}, {"medium.union_radius", 0.5f}})});
    EXPECT_EQ(simulation.now().medium.union_extinction, 2);
    EXPECT_EQ(simulation.now().medium.union_radius, 0.5f);
}

TEST(UnionMedium, ItRemembersTheLastTicks) {
    EXPECT_EQ(Simulation(cubeScene(10)).past(), nullptr);
    Scene emitted = plumeScene();
    emitted.medium.model = kUnionMedium;
    EXPECT_EQ(Simulation(emitted).past(), nullptr) << "its rows are not always the same particles";

    Scene scene = unionScene();
    scene.lights[0].rotate = 1;
    scene.simulation.volume_velocity = {1, 0, 0};
    Simulation simulation(scene);
    simulation.countFrom(1000);
    std::vector<std::vector<gpu::Particle>> particles{particlesOf(simulation)};
    std::vector<glm::vec3> lights{simulation.now().light.to_light};
    for (int i = 0; i < 100; ++i) {
        simulation.step({});
        particles.push_back(particlesOf(simulation));
        lights.push_back(simulation.now().light.to_light);
        ASSERT_NE(simulation.past(), nullptr);
        for (const int ago : {0, 1, 7, 63, 64, 90}) {
            const int kept = std::max({i + 1 - ago, i + 1 - 63, 0}); // the oldest for those before it
            const PastTick& then = simulation.past()->at(uint64_t(1000 + i + 1 - ago));
            EXPECT_EQ(then.tick, uint64_t(1000 + kept));
            EXPECT_EQ(then.to_light, lights[kept]);
            EXPECT_EQ(then.particles[3].centre, particles[kept][3].centre);
        }
    }
    EXPECT_NE(lights.front(), lights.back());
}

} // namespace
} // namespace brume
