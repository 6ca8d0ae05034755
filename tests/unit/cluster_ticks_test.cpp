// Ticks of a cluster's log as a frame loop takes them, who makes them, and commands on their way into the log.
#include "server/cluster/ticks.h"

#include <gtest/gtest.h>

#include "server/cluster/log.h"
#include "server/cluster/options.h"
#include "server/cluster/own_commands.h"
#include "server/cluster/ticker.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::cluster::ticks_test {
namespace {

NodeCommand said(const std::string& node, uint64_t number) { return {node, number, {3, uint32_t(number), Restart{}}}; }

struct Cluster : testing::Test {
    std::vector<SavedState> saved;
    std::vector<uint64_t> passed;
    Handover handover{[this](SavedState state) { saved.push_back(std::move(state)); },
                      [this](uint64_t tick) { passed.push_back(tick); }};
    ClusterTicks ticks{handover};
    std::vector<Command> commands;
    Clock::time_point now = Clock::now();
};

TEST_F(Cluster, TicksComeWithTheLogAlone) {
    Simulation simulation(cubeScene(10));
    handover.ticked(simulation);
    EXPECT_FALSE(ticks.take(now, commands));
    EXPECT_FALSE(ticks.serves());
    handover.give(3, {{1, 1, Restart{}}}, LogPoint{17, 5, "state of the log"});
    EXPECT_EQ(ticks.due(), Clock::time_point::min());
    std::vector<size_t> taken;
    while (ticks.take(now, commands)) {
        taken.push_back(commands.size());
        simulation.step(commands);
        handover.ticked(simulation);
    }
    EXPECT_EQ(taken, (std::vector<size_t>{1, 0, 0}));
    EXPECT_TRUE(ticks.serves());
    EXPECT_EQ(passed, (std::vector<uint64_t>{0, 1, 2, 3}));
    EXPECT_EQ(handover.hashOf(3), simulation.stateHash());
    EXPECT_FALSE(handover.hashOf(4));
    ASSERT_EQ(saved.size(), 1u) << "once, after the last tick of its message";
    EXPECT_EQ(saved[0].tick, 3u);
    EXPECT_EQ(saved[0].at.sequence, 17u);
    Simulation other(cubeScene(10));
    other.load(saved[0].simulation);
    EXPECT_EQ(other.stateHash(), saved[0].hash);
}

TEST_F(Cluster, FarBehindNothingIsDrawnUntilItHasCaughtUp) {
    handover.give(200, {}, {});
    ASSERT_TRUE(ticks.take(now, commands));
    EXPECT_TRUE(ticks.seeks());
    EXPECT_FALSE(ticks.serves());
    size_t until_drawn = 1;
    while (ticks.take(now, commands) && ticks.seeks()) ++until_drawn;
    EXPECT_GE(until_drawn, 190u);
    EXPECT_TRUE(ticks.serves());
}

TEST_F(Cluster, ABeginningReplacesWhatWasGiven) {
    handover.give(50, {}, {});
    ASSERT_TRUE(ticks.take(now, commands));
    handover.begin({std::byte{5}}, 500);
    handover.give(501, {}, {});
    EXPECT_FALSE(ticks.take(now, commands)) << "what was given belongs to the beginning";
    const auto beginning = ticks.beginning();
    ASSERT_TRUE(beginning);
    EXPECT_EQ(*beginning, std::vector{std::byte{5}});
    EXPECT_FALSE(ticks.serves());
    EXPECT_FALSE(ticks.beginning());
    EXPECT_TRUE(ticks.take(now, commands));
    EXPECT_FALSE(ticks.take(now, commands));
    EXPECT_TRUE(ticks.serves());
}

TEST_F(Cluster, AFailureEndsTheLoopAndAStandstillIsTold) {
    EXPECT_FALSE(ticks.stands());
    handover.stand("why");
    EXPECT_TRUE(ticks.stands());
    EXPECT_STREQ(ticks.standstill(), "why");
    handover.fail(std::make_exception_ptr(ClusterError("gone")));
    EXPECT_THROW(ticks.take(now, commands), ClusterError);
}

// A server whose commands go to this log, and come back from it.
struct Sender : testing::Test {
    Log log;
    OwnCommands own;
    Clock::time_point now = Clock::now();
    uint32_t seq = 0;

    std::string send() { return own.add({7, ++seq, Restart{}}, now); }
    void arrives(const std::string& message) {
        const auto read = unpack(message);
        const auto& command = std::get<NodeCommand>(*read);
        log.take(command);
        if (command.node == own.name()) own.came(command.number, log.lastNumber(own.name()), now);
    }
    std::vector<uint32_t> taken() { // seq of each command that the next tick takes
        std::vector<uint32_t> all;
        auto step = log.take(to(log.tick() + 1));
        for (NodeCommand& one : step->commands) {
            all.push_back(one.command.seq);
            EXPECT_EQ(own.take(std::move(one)).viewer, 7u);
        }
        return all;
    }
};

TEST_F(Sender, WhatIsLostOnTheWayIsSentAgainInItsOrder) {
    const std::vector<std::string> sent{send(), send(), send()};
    arrives(sent[0]);
    arrives(sent[2]); // the second is lost
    EXPECT_EQ(taken(), std::vector<uint32_t>{1});
    EXPECT_TRUE(own.overdue(now).empty());
    now += std::chrono::seconds(2);
    const auto again = own.overdue(now);
    EXPECT_EQ(again, (std::vector{sent[1], sent[2]}));
    EXPECT_TRUE(own.overdue(now).empty()) << "once a second";
    for (const std::string& message : again) arrives(message);
    for (const std::string& message : again) arrives(message); // twice changes nothing
    EXPECT_EQ(taken(), (std::vector<uint32_t>{2, 3}));
    EXPECT_EQ(own.resent(), 2u);
    EXPECT_EQ(own.lost(), 0u);
}

TEST_F(Sender, ForgottenByTheLogItGoesOnUnderAnotherName) {
    arrives(send());
    EXPECT_EQ(taken(), std::vector<uint32_t>{1});
    for (uint64_t tick = log.tick(); log.tick() <= kRemembered + kMostAdvance; tick += kMostAdvance)
        log.take(to(tick + kMostAdvance, "other"));
    const std::string name = own.name();
    arrives(send());
    EXPECT_NE(own.name(), name);
    for (const std::string& message : own.overdue(now)) arrives(message);
    EXPECT_EQ(taken(), std::vector<uint32_t>{2});
}

TEST_F(Sender, OfTooManyServersItKeepsItsNameAndTriesAgain) {
    for (size_t i = 0; i < kMostNodes; ++i) log.take(said("n" + std::to_string(i), 1));
    const std::string name = own.name(), message = send();
    arrives(message);
    EXPECT_EQ(own.name(), name);
    EXPECT_TRUE(own.overdue(now).empty()) << "not at once";
    now += std::chrono::seconds(2);
    EXPECT_EQ(own.overdue(now), std::vector{message});
}

TEST_F(Sender, WhenTheLogLosesItsEndWhatWasNotAnsweredIsSentAgain) {
    const std::string before = log.save();
    arrives(send());
    arrives(send());
    EXPECT_EQ(taken(), (std::vector<uint32_t>{1, 2}));
    log = Log::load(before);
    own.rejoined(log.lastNumber(own.name()), now);
    arrives(send());
    for (const std::string& message : own.overdue(now)) arrives(message);
    EXPECT_EQ(taken(), std::vector<uint32_t>{3});
    EXPECT_EQ(own.lost(), 2u);
}

TEST_F(Sender, AfterARejoinWhatTheStateHasIsNotSentAgain) {
    const std::vector<std::string> sent{send(), send()};
    own.rejoined(1, now); // the state has the first
    now += std::chrono::seconds(2);
    EXPECT_EQ(own.overdue(now), std::vector{sent[1]});
}

TEST_F(Sender, OnlySoManyAreOnTheirWay) {
    while (own.hasRoom()) send();
    EXPECT_EQ(seq, 64u);
    now += std::chrono::seconds(2);
    for (const std::string& message : own.overdue(now)) arrives(message);
    EXPECT_FALSE(own.hasRoom()) << "until a tick takes them";
    taken();
    EXPECT_TRUE(own.hasRoom());
}

struct Clocked : testing::Test {
    const Clock::time_point begin = Clock::now();
    Ticker ticker{begin};
    std::chrono::milliseconds at{0};
    uint64_t tick = 0;

    // Ticks that are published until then, looked at each millisecond; each has its effect at once unless they are
    // lost.
    std::vector<uint64_t> until(std::chrono::milliseconds end, bool mine, size_t rank = 0, bool lost = false) {
        std::vector<uint64_t> all;
        for (; at < end; ++at)
            if (const auto next = ticker.due(begin + at, {mine, rank, tick, 0})) {
                all.push_back(*next);
                if (lost) continue;
                tick = *next;
                ticker.ticked(begin + at);
            }
        return all;
    }
};

TEST_F(Clocked, WhoMakesTheTicksMakesSixtyASecond) {
    until(std::chrono::milliseconds(151), true);
    EXPECT_NEAR(double(until(std::chrono::milliseconds(1151), true).size()), 60, 1);
}

TEST_F(Clocked, OthersTakeOverInTheirTurn) {
    EXPECT_TRUE(until(std::chrono::milliseconds(300), false, 1).empty());
    EXPECT_EQ(until(std::chrono::milliseconds(302), false, 1), std::vector<uint64_t>{1});
    EXPECT_TRUE(until(std::chrono::milliseconds(400), false, 0).empty()) << "another one just did";
}

TEST_F(Clocked, LostOnesDoNotEndIt) {
    const auto lost = until(std::chrono::milliseconds(1500), true, 0, true);
    EXPECT_LE(*std::ranges::max_element(lost), 15u) << "it does not run ahead";
    EXPECT_EQ(tick, 0u);
    EXPECT_FALSE(until(std::chrono::milliseconds(1800), true).empty());
    EXPECT_GT(tick, 5u);
}

TEST_F(Clocked, ItDoesNotRunAheadOfItsOwnSimulation) {
    EXPECT_FALSE(ticker.due(begin + std::chrono::seconds(1), {true, 0, 100, 15}));
    EXPECT_EQ(ticker.due(begin + std::chrono::seconds(2), {true, 0, 100, 14}), 101u);
}

} // namespace
} // namespace brume::cluster::ticks_test
