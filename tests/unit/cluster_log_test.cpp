// The log of a cluster: every server computes the same of it, whoever publishes, however often and how late.
#include "server/cluster/log.h"

#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/cluster/identity.h"
#include "server/cluster/options.h"
#include "server/cluster/own_commands.h"
#include "server/cluster/ticker.h"
#include "server/cluster/ticks.h"
#include "server/cluster/votes.h"
#include "tests/unit/simulation_scenes.h"

namespace brume::cluster {
namespace {

NodeCommand said(const std::string& node, uint64_t number, CommandBody body = Restart{}) {
    return {node, number, {3, uint32_t(number), std::move(body)}};
}
Advance to(uint64_t tick, const std::string& node = "a") { return {node, tick}; }
Here here(const std::string& node, const std::string& url = {}, double load = 0) {
    return {node, 0, 1, url, load, !url.empty()};
}

TEST(ClusterLog, ATickTakesWhatCameBeforeIt) {
    Log log;
    EXPECT_FALSE(log.take(said("a", 1)));
    EXPECT_FALSE(log.take(said("b", 1)));
    const auto step = log.take(to(3));
    ASSERT_TRUE(step);
    EXPECT_EQ(step->first, 1u);
    EXPECT_EQ(step->last, 3u);
    ASSERT_EQ(step->commands.size(), 2u);
    EXPECT_EQ(step->commands[0].node, "a");
    EXPECT_EQ(step->commands[1].node, "b");
    EXPECT_EQ(log.tick(), 3u);
    EXPECT_EQ(log.ticker(), "a");
    ASSERT_TRUE(log.take(to(4, "b")));
    EXPECT_EQ(log.ticker(), "b");
}

TEST(ClusterLog, WhatIsPastOrFarAwayHasNoEffect) {
    Log log;
    ASSERT_TRUE(log.take(to(5)));
    EXPECT_FALSE(log.take(to(5, "zombie")));
    EXPECT_FALSE(log.take(to(1, "zombie")));
    EXPECT_FALSE(log.take(to(5 + kMostAdvance + 1, "zombie")));
    EXPECT_FALSE(log.take(to(~0ull, "zombie")));
    EXPECT_EQ(log.ticker(), "a");
    EXPECT_TRUE(log.take(to(5 + kMostAdvance)));
}

TEST(ClusterLog, ACommandIsTakenOnceAndInItsServersOrder) {
    Log log;
    const std::vector<uint64_t> numbers{1, 1, 3, 2, 2, 3, 1, 4};
    for (const uint64_t number : numbers) log.take(said("a", number));
    log.take(said("b", 2)); // before its first
    const auto step = log.take(to(1));
    ASSERT_TRUE(step);
    ASSERT_EQ(step->commands.size(), 4u);
    for (uint64_t i = 0; i < 4; ++i) EXPECT_EQ(step->commands[i].number, i + 1);
    EXPECT_EQ(log.lastNumber("a"), 4u);
    EXPECT_EQ(log.lastNumber("b"), 0u);
}

TEST(ClusterLog, PushesBeyondATicksMostWaitForTheNext) {
    Log log;
    for (uint64_t i = 1; i <= kMostImpulses + 5; ++i) log.take(said("a", i, Impulse{}));
    log.take(said("a", kMostImpulses + 6, MoveVolume{}));
    EXPECT_EQ(log.take(to(1))->commands.size(), kMostImpulses);
    EXPECT_EQ(log.take(to(2))->commands.size(), 6u);
    EXPECT_TRUE(log.take(to(3))->commands.empty());
}

TEST(ClusterLog, KnowsWhoIsThereAndWhoComesNext) {
    Log log;
    for (const char* name : {"c", "a", "b"}) log.take(here(name));
    EXPECT_EQ(log.rank("a"), 0u);
    EXPECT_EQ(log.rank("c"), 2u);
    EXPECT_EQ(log.rank("stranger"), 3u);
    log.take(to(1, "a"));
    EXPECT_EQ(log.rank("b"), 0u) << "the ticker does not count";
    EXPECT_EQ(log.rank("c"), 1u);
    for (uint64_t tick = 2; tick <= kHereFor; ++tick) log.take(to(tick));
    log.take(here("c"));
    EXPECT_EQ(log.present().size(), 3u);
    log.take(to(kHereFor + 1));
    ASSERT_EQ(log.present().size(), 1u);
    EXPECT_EQ(log.present()[0].node, "c");
}

TEST(ClusterLog, IsBoundedAgainstStrangers) {
    Log log;
    for (size_t i = 0; i < kMostNodes + 50; ++i) log.take(said("n" + std::to_string(i), 1));
    EXPECT_EQ(log.take(to(1))->commands.size(), kMostNodes);
    for (uint64_t tick = 1 + kMostAdvance; tick < kRemembered + 2 * kMostAdvance; tick += kMostAdvance)
        log.take(to(tick));
    EXPECT_EQ(log.lastNumber("n0"), 0u);
    log.take(said("new", 1));
    EXPECT_EQ(log.lastNumber("new"), 1u);
}

// A server that joins with a saved log goes on as one that was there all the time.
TEST(ClusterLog, SavedItGoesOnAlike) {
    std::mt19937 random(5);
    Log all, joined;
    std::map<std::string, uint64_t> next;
    bool has_joined = false;
    uint64_t steps = 0;
    for (int i = 0; i < 3000; ++i) {
        const std::string node(1, char('a' + random() % 3));
        LogMessage message = here(node, "ws://x", 0.5);
        if (const auto kind = random() % 10; kind < 5)
            message = said(node, ++next[node] - random() % 2, random() % 2 ? CommandBody(Impulse{}) : Restart{});
        else if (kind < 9)
            message = to(all.tick() + random() % 3, node);
        if (i == 1234) {
            joined = Log::load(all.save());
            has_joined = true;
        }
        const auto step = all.take(message);
        if (has_joined) {
            const auto theirs = joined.take(message);
            ASSERT_EQ(step.has_value(), theirs.has_value()) << i;
            if (step) {
                ++steps;
                ASSERT_EQ(step->first, theirs->first);
                ASSERT_EQ(step->last, theirs->last);
                ASSERT_EQ(step->commands.size(), theirs->commands.size());
            }
            ASSERT_EQ(all.save(), joined.save());
        }
    }
    EXPECT_GT(steps, 100u);
    EXPECT_THROW(Log::load("{}"), StateError);
    EXPECT_THROW(Log::load(all.save().substr(1)), StateError);
}

// Numbers that are none, of who writes into the store of the others.
TEST(ClusterLog, AStateWhoseNumbersAreNoneIsRefused) {
    const auto state = [](const char* tick, const char* number) {
        return fmt::format(
            R"({{"tick":{},"ticker":"a","nodes":{{"a":{{"number":{},"heard":0,"here_at":0}}}},"waiting":[]}})", tick,
            number);
    };
    EXPECT_EQ(Log::load(state("7", "18446744073709551615")).tick(), 7u);
    for (const char* none : {"1e30", "-1", "1.5", "18446744073709551616", R"("7")", "true", "null", "[]"}) {
        EXPECT_THROW(Log::load(state(none, "1")), StateError) << none;
        EXPECT_THROW(Log::load(state("7", none)), StateError) << none;
    }
}

TEST(ClusterMessage, ComesBackAsItWas) {
    for (const LogMessage& message :
         {LogMessage(said("a", ~0ull, Impulse{{1, 2, 3}, {0, 1, 0}, {0.1f, 0, 0}, 0.3f})), LogMessage(to(1ull << 60)),
          LogMessage(Here{"b", 60, ~0ull, "wss://cloud.example/", 0.25, true})}) {
        const std::string text = pack(message);
        const auto back = unpack(text);
        ASSERT_TRUE(back) << text;
        EXPECT_EQ(pack(*back), text);
    }
    for (const char* text :
         {"", "{", "{}", "7", R"({"is":"advance","node":"a"})", R"({"is":"advance","node":"","tick":1})",
          R"({"is":"other","node":"a"})", R"({"is":"advance","node":"a","tick":-1.5e300})",
          R"({"is":"command","node":"a","number":1,"input":"AAAA"})",
          R"({"is":"command","node":"a","number":1,"input":{}})"})
        EXPECT_FALSE(unpack(text)) << text;
    EXPECT_FALSE(unpack(std::string(100'000, '[')));
}

TEST(ClusterVotes, MostServersAreRightAndATieIsTheTickers) {
    Votes votes;
    EXPECT_FALSE(votes.winner(60, "a"));
    votes.note(60, "a", 7);
    votes.note(60, "b", 8);
    EXPECT_EQ(votes.winner(60, "a"), 7u);
    EXPECT_EQ(votes.winner(60, "b"), 8u);
    votes.note(60, "c", 8);
    EXPECT_EQ(votes.winner(60, "a"), 8u) << "the ticker is wrong";
    for (uint64_t tick = 120; tick < 3600; tick += 60) votes.note(tick, "a", 1);
    EXPECT_FALSE(votes.winner(60, "a")) << "only the last are kept";
}

TEST(ClusterIdentity, NamesWhatDiffers) {
    const Simulation simulation(cubeScene(10));
    const Identity own = identityOf(simulation, "cube", "text", {"a=1"});
    EXPECT_EQ(differenceOf(own, textOf(own)), "");
    const auto difference = [&](const Identity& other) { return differenceOf(own, textOf(other)); };
    EXPECT_NE(difference(identityOf(simulation, "cube", "text", {"a=2"})).find("--set"), std::string::npos);
    EXPECT_NE(difference(identityOf(simulation, "cube", "Text", {"a=1"})).find("file"), std::string::npos);
    EXPECT_NE(difference(identityOf(Simulation(cubeScene(10, 2)), "cube", "text", {"a=1"})).find("particles"),
              std::string::npos);
    EXPECT_NE(difference(identityOf(simulation, "box", "text", {"a=1"})).find("another scene"), std::string::npos);
    Identity older = own;
    older.version = "0.0.1/3.1";
    EXPECT_NE(difference(older).find("another version"), std::string::npos);
    EXPECT_NE(differenceOf(own, "somebody's stream\n").find("another version"), std::string::npos);
}

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
} // namespace brume::cluster
