// The load generator's parts that are about several servers: whether they agree, what each tells, pushes.
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "client/load/agreement.h"
#include "client/load/budget.h"
#include "client/load/histogram.h"
#include "client/load/pusher.h"
#include "client/load/report.h"
#include "client/load/server.h"
#include "client/load/servers_report.h"

namespace brume::load {
namespace {

TEST(LoadAgreement, CountsTicksThatTwoServersTold) {
    Agreement agreement;
    for (uint64_t tick = 1; tick <= 100; ++tick) {
        agreement.told(0, tick, tick * 7);
        agreement.told(0, tick, tick * 7); // another viewer of the same server
    }
    EXPECT_EQ(agreement.compared(), 0u);
    for (uint64_t tick = 51; tick <= 120; ++tick) agreement.told(1, tick, tick * 7);
    EXPECT_EQ(agreement.compared(), 50u);
    agreement.told(2, 60, 420); // a third server of a tick is no further tick
    EXPECT_EQ(agreement.compared(), 50u);
    EXPECT_EQ(agreement.equal(), 50u);
    EXPECT_FALSE(agreement.first());
}

TEST(LoadAgreement, TellsTheFirstTickThatDiffers) {
    Agreement agreement;
    for (const uint64_t tick : {9, 8, 7, 6}) agreement.told(0, tick, 1);
    agreement.told(1, 9, 1);
    agreement.told(1, 8, 2);
    agreement.told(1, 8, 2);
    agreement.told(2, 8, 2); // counted once a tick
    EXPECT_EQ(agreement.compared(), 2u);
    EXPECT_EQ(agreement.equal(), 1u);
    agreement.told(2, 7, 0xabc); // later told, but of an earlier tick
    ASSERT_TRUE(agreement.first());
    EXPECT_EQ(agreement.first()->tick, 7u);
    EXPECT_EQ(agreement.first()->server, 0u);
    EXPECT_EQ(agreement.first()->other, 2u);
    EXPECT_EQ(agreement.first()->hash, 1u);
    EXPECT_EQ(agreement.first()->other_hash, 0xabcu);
    EXPECT_EQ(agreement.equal(), 1u);
}

// A server that is started anew counts its ticks from 1, in states of its own.
TEST(LoadAgreement, AServersNewWordReplacesItsOldOne) {
    Agreement agreement;
    agreement.told(0, 5, 1);
    agreement.told(0, 5, 2);
    EXPECT_FALSE(agreement.first());
    agreement.told(1, 5, 2);
    EXPECT_EQ(agreement.compared(), 1u);
    EXPECT_FALSE(agreement.first());
}

TEST(LoadAgreement, RemembersAWindowOfTicks) {
    Agreement agreement;
    constexpr uint64_t window = Agreement::kWindow;
    agreement.told(0, 1, 1);
    agreement.told(0, window, 1);
    agreement.told(1, 1, 1);
    EXPECT_EQ(agreement.compared(), 1u) << "still in the window";
    agreement.told(0, window + 2, 1);
    agreement.told(1, 2, 2); // its place belongs to a newer tick
    EXPECT_EQ(agreement.compared(), 1u);
    EXPECT_FALSE(agreement.first());
    agreement.told(1, window + 2, 1);
    EXPECT_EQ(agreement.compared(), 2u);
}

// 10 samples to 1 ms, 80 more to 2 ms, 10 more beyond the last bound.
const std::string kTen =
    "h_bucket{le=\"0.001\"} 10\nh_bucket{le=\"0.002\"} 90\nh_bucket{le=\"+Inf\"} 100\nh_count 100\n"
    "h_sum 0.2\nh_other_bucket{le=\"0.001\"} 5\n";

TEST(LoadHistogram, InterpolatesInsideBuckets) {
    const Series none, ten = parseSeries(kTen);
    EXPECT_NEAR(percentileBetween(none, ten, "h", 0.05), 0.0005, 1e-12);
    EXPECT_NEAR(percentileBetween(none, ten, "h", 0.1), 0.001, 1e-12);
    EXPECT_NEAR(percentileBetween(none, ten, "h", 0.5), 0.0015, 1e-12);
    EXPECT_NEAR(percentileBetween(none, ten, "h", 0.9), 0.002, 1e-12);
    EXPECT_NEAR(percentileBetween(none, ten, "h", 0.95), 0.002, 1e-12) << "beyond the last bound";
}

TEST(LoadHistogram, CountsWhatGrewAndNothingElse) {
    const Series ten = parseSeries(kTen);
    const Series more =
        parseSeries("h_bucket{le=\"0.001\"} 10\nh_bucket{le=\"0.002\"} 94\nh_bucket{le=\"+Inf\"} 104\nh_count 104\n");
    EXPECT_NEAR(percentileBetween(ten, more, "h", 0.5), 0.0015, 1e-12) << "four between 1 and 2 ms";
    EXPECT_TRUE(std::isnan(percentileBetween(ten, ten, "h", 0.5))) << "nothing came";
    EXPECT_TRUE(std::isnan(percentileBetween(more, ten, "h", 0.5))) << "the server began anew";
    EXPECT_TRUE(std::isnan(percentileBetween({}, ten, "g", 0.5))) << "there is none";
}

TEST(LoadServers, TellWhatTheirCountersSay) {
    const Series before = parseSeries("brume_tick_seconds_count 100\nbrume_cluster_log_bytes_total{way=\"in\"} 1000\n"
                                      "brume_cluster_log_bytes_total{way=\"out\"} 500\nprocess_cpu_seconds_total 1\n");
    const Series after = parseSeries("brume_tick_seconds_count 220\nbrume_cluster_log_bytes_total{way=\"in\"} 5000\n"
                                     "brume_cluster_log_bytes_total{way=\"out\"} 900\nbrume_cluster_lag_ticks 2\n"
                                     "brume_command_to_tick_seconds_bucket{le=\"0.02\"} 100\n"
                                     "brume_command_to_tick_seconds_bucket{le=\"+Inf\"} 100\n"
                                     "process_cpu_seconds_total 3\n");
    ServerRun server;
    readCounters(server, before, after, 2);
    EXPECT_EQ(server.ticks_per_second, 60);
    EXPECT_EQ(server.log_bytes_per_second, 2200);
    EXPECT_EQ(server.lag_ticks, 2);
    EXPECT_NEAR(server.command_p50_ms, 10, 1e-9);
    EXPECT_NEAR(server.command_p95_ms, 19, 1e-9);
    EXPECT_EQ(server.cost.cpu_s, 2);

    ServerRun plain; // a server without a cluster
    readCounters(plain, parseSeries("a 1\n"), parseSeries("a 2\n"), 2);
    for (const double value : {plain.log_bytes_per_second, plain.lag_ticks, plain.command_p95_ms, plain.tick_p50_ms})
        EXPECT_TRUE(std::isnan(value));
    readCounters(plain, after, before, 2);
    EXPECT_TRUE(std::isnan(plain.ticks_per_second)) << "it began anew";
}

TEST(LoadServers, TogetherTheyCostTheSum) {
    std::vector<ServerRun> servers(2);
    servers[0].cost.cpu_s = 1, servers[1].cost.cpu_s = 2;
    servers[0].cost.plan_error = 0.5, servers[1].cost.plan_error = 0.25;
    servers[0].cost.passes_ms = {{"a", 1}}, servers[1].cost.passes_ms = {{"a", 3}, {"b", 2}};
    EXPECT_EQ(total(servers).cpu_s, 3);
    EXPECT_EQ(total(servers).plan_error, 0.5);
    EXPECT_EQ(total(servers).passes_ms, (std::map<std::string, double>{{"a", 3}, {"b", 2}}));
    servers[1].cost.cpu_s = NAN;
    EXPECT_TRUE(std::isnan(total(servers).cpu_s)) << "a part of the sum is not known";
}

// Two servers, of which the second differs at tick 40, and a viewer that came back twice.
Report aReport() {
    Report report;
    Run run;
    run.viewers = 2;
    run.seconds = 2;
    run.frames = {30, 20};
    run.servers.resize(2);
    run.servers[0].url = "ws://a/ws", run.servers[1].url = "ws://b/ws";
    run.servers[0].frames = 30, run.servers[1].frames = 20;
    for (int i = 1; i <= 100; ++i) run.servers[0].picture_ms.push_back(float(i));
    run.servers[0].pushes = 8, run.servers[0].refused = 2;
    run.servers[0].command_p50_ms = 9, run.servers[0].command_p95_ms = 17, run.servers[1].command_p95_ms = 25;
    run.agreement.emplace();
    for (uint64_t tick = 37; tick <= 40; ++tick) {
        run.agreement->told(0, tick, 0x10 + tick);
        run.agreement->told(1, tick, 0x10 + (tick < 40 ? tick : 0));
    }
    run.returns = {{1'000'000, 1'250'000}, {3'000'000, 3'750'000}};
    report.runs.push_back(std::move(run));
    return report;
}

Options ofTwoServers() {
    Options options;
    options.servers = {client::parseUrl("ws://a"), client::parseUrl("ws://b")};
    return options;
}

TEST(LoadServers, TheReportTellsEachAndWhetherTheyAgree) {
    const Report report = aReport();
    const auto run = json(report, ofTwoServers())["runs"][0];
    ASSERT_EQ(run["servers"].size(), 2u);
    EXPECT_EQ(run["servers"][0]["url"], "ws://a/ws");
    EXPECT_EQ(run["servers"][0]["tick_to_picture_ms"]["p95"], 95);
    EXPECT_EQ(run["servers"][0]["inputs_sent"], 8);
    EXPECT_EQ(run["servers"][0]["inputs_refused"], 2);
    EXPECT_EQ(run["servers"][0]["command_to_tick_ms"]["p95"], 17);
    EXPECT_TRUE(run["servers"][1]["tick_to_picture_ms"]["p50"].is_null());
    EXPECT_EQ(run["agreement"]["ticks_compared"], 4);
    EXPECT_EQ(run["agreement"]["ticks_equal"], 3);
    EXPECT_EQ(run["agreement"]["percent"], 75);
    EXPECT_EQ(run["agreement"]["first_difference"]["tick"], 40);
    EXPECT_EQ(run["agreement"]["first_difference"]["servers"][1], "ws://b/ws");
    EXPECT_EQ(run["away_ms"]["p50"], 250);
    EXPECT_EQ(run["away_ms"]["most"], 750);
    EXPECT_EQ(differenceLine(report.runs[0]),
              "tick 40 is not the same everywhere with 2 viewers: ws://a/ws has state 0000000000000038, "
              "ws://b/ws has state 0000000000000010");

    const std::string text = markdown(report, ofTwoServers());
    EXPECT_NE(text.find("| 2 | ws://a/ws | 0 | 15.0 | 50.0 | 95.0 | 4.00 | 1.00 | 9.00 | 17.0 |"), text.npos) << text;
    EXPECT_NE(text.find("- 2 viewers: 4 ticks compared, 3 equal (75.0 %)"), text.npos) << text;
    EXPECT_NE(text.find("- 2 viewers: 2 times one came back, after 750 ms at most, 250 ms at the median"), text.npos)
        << text;
}

TEST(LoadServers, NearlyAllIsNotAHundredPercent) {
    Report report = aReport();
    for (uint64_t tick = 1000; tick < 1000 + 3000; ++tick)
        for (const size_t server : {0, 1}) report.runs[0].agreement->told(server, tick, 1);
    const std::string text = markdown(report, ofTwoServers());
    EXPECT_NE(text.find("3004 ticks compared, 3003 equal (99.9 %)"), text.npos) << text;
}

TEST(LoadServers, OfOneServerNothingIsCompared) {
    Report report = aReport();
    report.runs[0].servers.resize(1);
    report.runs[0].agreement.reset();
    EXPECT_FALSE(json(report, {})["runs"][0].contains("servers"));
    EXPECT_EQ(markdown(report, {}).find("compared"), std::string::npos);
    EXPECT_EQ(differenceLine(report.runs[0]), "");
    Options pushing;
    pushing.push = 1;
    EXPECT_EQ(json(report, pushing)["runs"][0]["servers"].size(), 1u);
    EXPECT_FALSE(json(report, pushing)["runs"][0].contains("agreement"));
    EXPECT_EQ(markdown(report, pushing).find("compared"), std::string::npos);
}

TEST(LoadBudget, CommandsAreJudgedByTheSlowestServer) {
    auto run = aReport().runs[0];
    EXPECT_EQ(broken(parseBudget("command_p95<=25"), run), "");
    EXPECT_EQ(broken(parseBudget("command_p95<=24@2"), run),
              "command_p95<=24@2 does not hold with 2 viewers: it is 25");
    run.servers[1].command_p95_ms = NAN; // one that took no commands
    EXPECT_EQ(broken(parseBudget("command_p95<=17"), run), "");
    run.servers[0].command_p95_ms = NAN;
    EXPECT_NE(broken(parseBudget("command_p95<=1e9"), run), "") << "that nothing is known is no success";
}

TEST(LoadPusher, TheSameSeedPushesTheSameWay) {
    const client::CameraPath path{client::PathKind::orbit, {0, 2, 26}, {1, 0, 0}, 0.8f};
    const auto pushes = [&](uint64_t seed) {
        Pusher pusher(10, seed, 0.5);
        std::vector<client::Impulse> all;
        for (uint64_t now = 1; now <= 2'000'000; now += 1000)
            if (const auto push = pusher.due(now, path.position, path)) all.push_back(*push);
        return all;
    };
    const auto one = pushes(1), again = pushes(1), other = pushes(2);
    EXPECT_NEAR(double(one.size()), 20, 1);
    ASSERT_EQ(one.size(), again.size());
    for (size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one[i].direction, again[i].direction);
        EXPECT_EQ(one[i].strength, again[i].strength);
        EXPECT_EQ(one[i].origin, path.position);
        EXPECT_NEAR(glm::length(one[i].direction), 1, 1e-5);
        // It passes the middle at a tenth of the distance at most, along each axis.
        const glm::vec3 to = path.target - path.position;
        const float beside = glm::length(to - one[i].direction * glm::dot(to, one[i].direction));
        EXPECT_LE(beside, 0.1f * std::sqrt(3.0f) * glm::length(to) * 1.01f);
        EXPECT_TRUE(i == 0 || one[i].direction != one[i - 1].direction) << i;
    }
    EXPECT_NE(one[0].direction, other[0].direction);
    EXPECT_TRUE(std::isfinite(pushes(3)[0].direction.x));
}

TEST(LoadPusher, WithoutARateThereIsNone) {
    Pusher pusher(0, 1, 0);
    EXPECT_EQ(pusher.nextUs(), Pusher::kNever);
    EXPECT_FALSE(pusher.due(client::nowUs(), {0, 0, 0}, {}));
}

} // namespace
} // namespace brume::load
