// Layout `sequence` with points that have velocities.
#include "server/sim/sequence.h"

#include <map>

#include "tests/unit/sequences.h"

namespace brume::sequences_test {
namespace {

// A third of the way: one file has faded by that, and the next has come, both where they are then.
TEST_F(Sequences, FilesOfPointsWithVelocitiesFadeIntoEachOther) {
    const std::string moving = kXyz + "float sigma_t\nfloat vx\nfloat vy\nfloat vz\n";
    put("smoke-000.ply", moving, "0 0 0 3 100 0 0\n0 0 0 6 0 10 -10\n");
    put("smoke-003.ply", moving, "0 0 1000 9 0 0 200\n");
    const Scene played = scene("rate = 10\nunit = 'cm'\nup = 'z'\n");
    Simulation simulation(played);
    EXPECT_EQ(simulation.capacity(), 3u);
    EXPECT_EQ(simulation.liveCount(), 2u);
    run(simulation, 6); // 0.1 s
    const auto now = particlesOf(simulation);
    ASSERT_EQ(now.size(), 3u);
    EXPECT_LT(glm::distance(now[0].centre, glm::vec3(0.1f, 0, 0)), 1e-6f);
    EXPECT_LT(glm::distance(now[1].centre, glm::vec3(0, -0.01f, -0.01f)), 1e-6f); // z is up
    EXPECT_LT(glm::distance(now[2].centre, glm::vec3(0, 9.6f, 0)), 1e-5f);
    EXPECT_NEAR(now[0].sigma_t / now[1].sigma_t, 0.5, 1e-6);
    EXPECT_NEAR(now[2].sigma_t / now[0].sigma_t, 9.0 / 3 / 2, 1e-5); // a third and two thirds
    run(simulation, 12);
    ASSERT_EQ(simulation.liveCount(), 1u);
    EXPECT_EQ(particlesOf(simulation)[0].centre, glm::vec3(0, 10, 0));
    EXPECT_NE(lines(played).find("by their velocities"), std::string::npos) << lines(played);
    EXPECT_NE(lines(played).find("1 to 2 points"), std::string::npos) << lines(played);
}

// Who draws between two ticks takes particles of one id for the same.
TEST_F(Sequences, AParticleKeepsItsIdWhileItIsThere) {
    const std::string moving = kXyz + "float vx\nfloat vy\nfloat vz\n";
    put("smoke-000.ply", moving, "0 0 0 5 0 0\n9 0 0 5 0 0\n");
    put("smoke-001.ply", moving, "0.5 0 0 5 0 0\n9.5 0 0 5 0 0\n50 0 0 5 0 0\n");
    put("smoke-002.ply", moving, "1 0 0 5 0 0\n");
    Simulation simulation(scene());
    std::map<uint64_t, float> last;
    uint64_t stayed = 0;
    for (int i = 0; i < 60; ++i) { // more than three rounds
        simulation.step({});
        std::map<uint64_t, float> now;
        for (const float x : xs(simulation)) now[simulation.firstId() + now.size()] = x;
        for (const auto& [id, x] : now)
            if (const auto was = last.find(id); was != last.end()) {
                ++stayed;
                EXPECT_NEAR(x - was->second, 5.0 / 60, 1e-4) << "tick " << i << ", id " << id;
            }
        last = std::move(now);
    }
    EXPECT_GT(stayed, 60u);
    EXPECT_EQ(simulation.firstId(), 3 * 6 + 2u);
}

TEST_F(Sequences, VelocitiesComeBeforeIds) {
    const std::string moving = kIds + "float vx\nfloat vy\nfloat vz\n";
    put("smoke-000.ply", moving, "0 0 0 1 2 0 0\n");
    put("smoke-001.ply", moving, "0 1 0 1 0 0 0\n");
    Simulation simulation(scene("rate = 1\nloop = false\n"));
    run(simulation, 30);
    EXPECT_EQ(xs(simulation), (Floats{1, 0}));
    run(simulation, 600); // the last one stays
    EXPECT_EQ(xs(simulation), (Floats{0}));
}

TEST_F(Sequences, VelocitiesThatCannotBeAreSaid) {
    const std::string moving = kXyz + "float vx\nfloat vy\nfloat vz\n";
    put("smoke-000.ply", moving, "0 0 0 nan 0 0\n1 0 0 0 0 0\n");
    EXPECT_NE(lines(scene()).find("vx is nan; allowed: -10000 to 10000"), std::string::npos) << lines(scene());
    put("smoke-001.ply", kXyz, "0 0 0\n");
    EXPECT_NE(errorOf().find("no velocities; the first file of the sequence has: "), std::string::npos) << errorOf();
    put("smoke-001.ply", kXyz + "float vx\nfloat vy\n", "0 0 0 1 1\n");
    EXPECT_NE(errorOf().find("no velocities"), std::string::npos) << "two of three are none";
}

} // namespace
} // namespace brume::sequences_test
