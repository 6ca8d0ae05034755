// The log of a cluster: every server computes the same of it, whoever publishes, however often and how late.
#include "server/cluster/log.h"

#include <random>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/cluster/identity.h"
#include "server/cluster/options.h"
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

} // namespace
} // namespace brume::cluster
