// The queue of commands between viewers and the simulation.
#include <gtest/gtest.h>

#include "server/sim/command.h"

namespace brume {
namespace {

TEST(CommandQueue, HandsOutInOrderAndRefusesWhenFull) {
    CommandQueue queue(3);
    std::vector<Command> out{{9, 9, Restart{}}};
    for (uint32_t seq = 1; seq <= 3; ++seq) EXPECT_TRUE(queue.push({7, seq, Restart{}}));
    EXPECT_FALSE(queue.push({7, 4, Restart{}}));
    queue.drain(out);
    ASSERT_EQ(out.size(), 3u);
    for (uint32_t i = 0; i < 3; ++i) EXPECT_EQ(out[i].seq, i + 1);
    EXPECT_TRUE(queue.push({7, 5, Restart{}}));
}

TEST(CommandQueue, TakesAsManyImpulsesAsATickDoes) {
    CommandQueue queue;
    std::vector<Command> out;
    for (int tick = 0; tick < 2; ++tick) {
        for (uint32_t seq = 1; seq <= kMostImpulses; ++seq) ASSERT_TRUE(queue.push({1, seq, Impulse{}})) << seq;
        EXPECT_FALSE(queue.push({2, 1, Impulse{}})) << "whoever pushes";
        EXPECT_TRUE(queue.push({1, kMostImpulses + 1, MoveVolume{}})) << "others are not impulses";
        EXPECT_FALSE(queue.push({1, kMostImpulses + 2, Impulse{}}));
        queue.drain(out);
        EXPECT_EQ(out.size(), kMostImpulses + 1);
    }
}

TEST(CommandQueue, TakesABoundedNumberOfRows) {
    CommandQueue queue;
    std::vector<Command> out;
    ParticleRows rows;
    rows.positions.resize(kMostRows);
    rows.scales.resize(kMostRows);
    rows.extinctions.resize(kMostRows);
    const SetParticles set{.rows = std::make_shared<const ParticleRows>(std::move(rows))};
    for (int tick = 0; tick < 2; ++tick) {
        size_t taken = 0;
        while (taken < 4096 && queue.push({1, 1, set})) ++taken;
        EXPECT_EQ(taken, kMostRowBytes / set.rows->bytes());
        EXPECT_TRUE(queue.push({1, 1, Restart{}})) << "others have room";
        queue.drain(out);
    }
}

TEST(CommandQueue, TakesNoMoreThanThereIsTimeFor) {
    CommandQueue queue;
    const Add lamp{SceneList::lights, {}}, bright{SceneList::lights, {{SceneList::lights, "light.shadows", false}}};
    const Set dimmed{{"light[0].shadows", true}};
    EXPECT_TRUE(queue.push({1, 1, lamp})) << "nothing is priced yet";
    queue.price({.left = 10, .light = 1, .shadowed_light = 4});
    EXPECT_TRUE(queue.push({1, 2, lamp}));
    EXPECT_TRUE(queue.push({1, 3, dimmed}));
    EXPECT_FALSE(queue.push({1, 4, lamp}));
    EXPECT_NE(whyRefused(queue, lamp).find("4 ms longer, and 3 are left"), std::string::npos);
    EXPECT_FALSE(queue.push({1, 5, Set{{"light[0].shadows", true}, {"light[1].shadows", true}}}));
    EXPECT_TRUE(queue.push({1, 6, Set{{"light[0].shadows", false}}}));
    for (uint32_t seq = 7; seq < 10; ++seq) EXPECT_TRUE(queue.push({1, seq, bright}));
    EXPECT_FALSE(queue.push({1, 10, bright}));
    EXPECT_TRUE(queue.push({1, 11, Remove{SceneList::lights, 0}})) << "what lessens it is taken";
    EXPECT_TRUE(queue.push({1, 12, Add{SceneList::fogs, {}}}));
    std::vector<Command> out;
    queue.drain(out);
    EXPECT_FALSE(queue.push({1, 13, lamp})) << "it is priced anew, not by the next tick";
    queue.price({.left = 4, .light = 1, .shadowed_light = 4});
    EXPECT_TRUE(queue.push({1, 14, lamp}));
    const Add box{SceneList::boxes, {}}, sphere{SceneList::spheres, {}}, plane{SceneList::planes, {}};
    queue.price({.left = 10, .plane = 4, .body = 3});
    for (const Add& one : {plane, box, sphere}) EXPECT_TRUE(queue.push({1, 15, one}));
    for (const Add& one : {plane, box, sphere}) EXPECT_FALSE(queue.push({1, 16, one}));
    const Add ball{SceneList::spheres, {{SceneList::spheres, "sphere.radius", 9.f}}};
    const Set grown{{"sphere[0].radius", 9.f}}, moved{{"sphere[0].centre", glm::vec3(1)}};
    queue.price({.left = 10, .body = 3, .growth = 2});
    EXPECT_TRUE(queue.push({1, 17, ball}));
    EXPECT_TRUE(queue.push({1, 18, grown}));
    EXPECT_TRUE(queue.push({1, 19, grown}));
    EXPECT_FALSE(queue.push({1, 20, grown}));
    EXPECT_TRUE(queue.push({1, 21, moved}));
}

} // namespace
} // namespace brume
