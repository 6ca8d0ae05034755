// The load generator's parts that need no server.
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "client/load/options.h"
#include "client/load/published.h"
#include "client/load/report.h"
#include "client/load/scrape.h"
#include "client/load/server.h"
#include "client/load/usage.h"

namespace brume::load {
namespace {

std::optional<Options> parsed(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "brume-load");
    int exit_code = 0;
    testing::internal::CaptureStderr();
    auto options = parseOptions(static_cast<int>(arguments.size()), arguments.data(), exit_code);
    const std::string err = testing::internal::GetCapturedStderr();
    EXPECT_EQ(exit_code, options ? 0 : 2);
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), options ? 0 : 1) << err;
    return options;
}

// Two viewers with 20 and 30 frames in 2 s, that cost 1 s of CPU.
Run aRun() {
    Run run;
    run.viewers = 2;
    run.seconds = 2;
    run.frames = {30, 20};
    for (int i = 1; i <= 100; ++i) run.latencies_ms.push_back(float(i));
    run.bytes = 50'000;
    run.server.cpu_s = 1;
    run.server.rendered = 50;
    run.server.shared_s = 0.1;
    run.server.views_s = 0.4;
    return run;
}

TEST(LoadOptions, GoodOnes) {
    const auto options =
        parsed({"--viewers", "1,3,256", "--seconds", "2.5", "--paths", "orbit,fly,still,stereo,walk", "--width", "320",
                "--height", "180", "--decode", "--fixed-size", "--start", "--scene plume --set 'medium.count=7'",
                "--assert", "fps>=15@3", "--assert", "p95<=2e2"});
    ASSERT_TRUE(options);
    EXPECT_EQ(options->viewers, (std::vector<uint32_t>{1, 3, 256}));
    ASSERT_EQ(options->paths.size(), 5u);
    EXPECT_EQ(options->paths[4].kind, client::PathKind::walk);
    EXPECT_TRUE(options->wishes.keep_size);
    EXPECT_EQ(options->paths[1].kind, client::PathKind::fly);
    EXPECT_TRUE(options->paths[3].stereo);
    EXPECT_EQ(options->wishes.width, 320);
    EXPECT_EQ(options->server_arguments, (std::vector<std::string>{"--scene", "plume", "--set", "medium.count=7"}));
    EXPECT_TRUE(options->servers.empty());
    ASSERT_EQ(options->budgets.size(), 2u);
    EXPECT_EQ(options->budgets[0].viewers, 3u);
    EXPECT_EQ(options->budgets[1].bound, 200);
    for (const char* here : {"ws://127.0.0.1:9", "ws://127.8.0.1", "ws://localhost", "ws://[::1]:9"})
        EXPECT_TRUE(parsed({"--server", here})) << here;
    EXPECT_TRUE(parsed({"--server", "ws://192.0.2.1", "--anywhere"}));

    const auto several = parsed({"--server", "ws://127.0.0.1:1,http://127.0.0.1:2,ws://[::1]:1", "--push", "2.5",
                                 "--seed", "7", "--assert", "command_p95<=50", "--reconnect"});
    ASSERT_TRUE(several);
    ASSERT_EQ(several->servers.size(), 3u);
    EXPECT_EQ(several->servers[1].url(), "ws://127.0.0.1:2/ws");
    EXPECT_EQ(several->push, 2.5);
    EXPECT_EQ(several->seed, 7u);
}

TEST(LoadOptions, BadOnesEndInOneLine) {
    for (const std::vector<const char*>& bad :
         std::vector<std::vector<const char*>>{{"--viewers", "0"},
                                               {"--viewers", "1001"},
                                               {"--viewers", "1,x"},
                                               {"--viewers", "-1"},
                                               {"--viewers", ""},
                                               {"--viewers", "1", "2"},
                                               {"--seconds", "0"},
                                               {"--seconds", "3601"},
                                               {"--seconds", "nan"},
                                               {"--paths", "orbit,run"},
                                               {"--width", "8"},
                                               {"--server", "ftp://127.0.0.1"},
                                               {"--server", "ws://192.0.2.1"},
                                               {"--server", "ws://example.com"},
                                               {"--server", "ws://[::2]"},
                                               {"--server", "ws://127.0.0.1:1,ws://192.0.2.1"},
                                               {"--server", "ws://127.0.0.1:1,http://127.0.0.1:1"},
                                               {"--server", "ws://127.0.0.1:1", "ws://127.0.0.1:2"},
                                               {"--push", "-1"},
                                               {"--push", "nan"},
                                               {"--push", "1001"},
                                               {"--seed", "-1"},
                                               {"--seed", "x"},
                                               {"--server", "ws://127.0.0.1", "--start", "--scene cloud"},
                                               {"--reconnect"},
                                               {"--start", "a 'b"},
                                               {"--start", "$(true)"},
                                               {"--assert", "fps"},
                                               {"--assert", "fps>=x"},
                                               {"--assert", "fps>=nan"},
                                               {"--assert", "fps=1"},
                                               {"--assert", "fpss>=1"},
                                               {"--assert", "f>=1"},
                                               {"--assert", ">=1"},
                                               {"--assert", "fps>=1@"},
                                               {"--assert", "fps>=1@2x"},
                                               {"--assert", "fps>=1@3"},
                                               {"--no-such-flag"}})
        EXPECT_FALSE(parsed(bad)) << bad.front() << ' ' << bad.back();
}

TEST(LoadBudget, HoldsOrSaysWhatIs) {
    const auto run = aRun();
    EXPECT_EQ(run.leastFps(), 10);
    EXPECT_EQ(run.mostFps(), 15);
    EXPECT_EQ(broken(parseBudget("fps>=10"), run), "");
    EXPECT_EQ(broken(parseBudget("fps>=10.1"), run), "fps>=10.1 does not hold with 2 viewers: it is 10");
    EXPECT_EQ(broken(parseBudget("fps>=10.1@2"), run), "fps>=10.1@2 does not hold with 2 viewers: it is 10");
    EXPECT_EQ(broken(parseBudget("fps>=10.1@4"), run), ""); // about another run
    EXPECT_EQ(broken(parseBudget("p50<=50"), run), "");
    EXPECT_NE(broken(parseBudget("p95<=94"), run), "");
    EXPECT_NE(broken(parseBudget("p99<=98.9"), run), "");
    EXPECT_EQ(broken(parseBudget("cpu<=0.5"), run), "");
    EXPECT_NE(broken(parseBudget("cpu<=0.49"), run), "");

    auto nothing = run; // that nothing came, or that nothing is known, is no success
    nothing.frames = {0, 30};
    nothing.latencies_ms.clear();
    nothing.server.cpu_s = NAN;
    for (const char* text : {"fps>=1", "p50<=1e9", "p99<=1e9", "cpu<=1e9", "cpu>=0"})
        EXPECT_NE(broken(parseBudget(text), nothing), "") << text;
}

TEST(LoadSeries, ReadsTheExpositionFormat) {
    const Series series = parseSeries("# HELP a What a is.\n# TYPE a counter\na 1.5\nb{x=\"y z\",w=\"}\"} 2e3\n"
                                      "c{le=\"+Inf\"} 7 1700000000\n\nbroken\nd NaN\ne nothing\nlast 3");
    EXPECT_EQ(series.at("a"), 1.5);
    EXPECT_EQ(series.at("b{x=\"y z\",w=\"}\"}"), 2000);
    EXPECT_EQ(series.at("c{le=\"+Inf\"}"), 7);
    EXPECT_TRUE(std::isnan(series.at("d")));
    EXPECT_EQ(series.at("last"), 3);
    EXPECT_EQ(series.size(), 5u);
}

TEST(LoadSeries, CostIsWhatGrewAndNanWhatIsNotThere) {
    const ServerCost cost =
        costBetween(parseSeries("process_cpu_seconds_total 2\nbrume_device_seconds_total{part=\"shared\"} 0.5\n"),
                    parseSeries("process_cpu_seconds_total 5\nbrume_device_seconds_total{part=\"shared\"} 0.75\n"
                                "brume_pass_seconds{pass=\"read back\"} 0.002\nbrume_plan_relaxed 1\n"));
    EXPECT_EQ(cost.cpu_s, 3);
    EXPECT_EQ(cost.shared_s, 0.25);
    EXPECT_EQ(cost.relaxed, 1);
    EXPECT_EQ(cost.passes_ms, (std::map<std::string, double>{{"read back", 2}}));
    EXPECT_TRUE(std::isnan(cost.views_s));
    EXPECT_TRUE(std::isnan(cost.memory_bytes));
}

// What the machine's cores did, in clock ticks: user nice system idle iowait irq softirq steal guest guest_nice.
TEST(LoadUsage, CoresThatWaitForADiskOrTheirHostDoNotWork) {
    const auto seconds = [](const char* text) {
        std::istringstream file(text);
        return busySeconds(file) * double(sysconf(_SC_CLK_TCK));
    };
    EXPECT_EQ(seconds("cpu  1000 200 30 0 0 4 5 0 0 0\ncpu0 500 100 15 0 0 2 3 0 0 0\n"), 1239);
    EXPECT_EQ(seconds("cpu  1000 200 30 90000 8000 4 5 7000 600 50\n"), 1239)
        << "idle, iowait, steal; guests are in user and nice";
    EXPECT_TRUE(std::isnan(seconds("")));
    EXPECT_TRUE(std::isnan(seconds("cpu  1000 200\n")));
    EXPECT_TRUE(std::isnan(seconds("intr 1000 200 30 0 0 4 5 0 0 0\n")));
}

TEST(LoadReport, SaysWhatWasMeasuredBesideWhatIsPublished) {
    Report report{"brume", "cloud", "a device", 640, 360, "2 cores", {aRun(), aRun()}, {"fps>=11 does not hold"}};
    report.runs[0].viewers = 1; // one viewer's 10 frames cost what two viewers' 50 do
    report.runs[0].frames = {10};
    report.runs[0].server.rendered = 10;
    report.runs[1].errors_measured = {0.0078125f, 0.00390625f, 0.001953125f};
    const Options options;
    const nlohmann::json j = json(report, options);
    EXPECT_EQ(j["runs"][1]["fps"]["least"], 10);
    EXPECT_EQ(j["runs"][1]["latency_ms"]["p95"], 95);
    EXPECT_EQ(j["runs"][1]["server"]["cpu_ms_per_frame"], 20);
    EXPECT_EQ(j["runs"][1]["server"]["device_shared_ms"], 100);
    EXPECT_EQ(j["runs"][1]["bytes_per_second"], 25'000);
    EXPECT_EQ(j["broken"][0], "fps>=11 does not hold");
    EXPECT_EQ(j["runs"][0]["error_measured"]["worst"], nullptr);
    EXPECT_EQ(j["runs"][1]["error_measured"]["median"], 0.00390625);
    EXPECT_EQ(j["runs"][1]["error_measured"]["worst"], 0.0078125);
    EXPECT_NE(tableLine(report.runs[1]).find("| 0.39 | 0.78 |"), std::string::npos) << tableLine(report.runs[1]);

    const std::string text = markdown(report, options);
    // 100 ms a frame alone, 20 of two; San Miguel: 2.13 / (2 * 1.10) and 1.57 / (2 * 0.91).
    EXPECT_NE(text.find("| 2 | 0.20 | 0.20 | 0.97 | 0.86 |"), text.npos) << text;
    EXPECT_NE(text.find("- fps>=11 does not hold"), text.npos);
    EXPECT_NE(plot(report).find("shared grid, Bistro 0.5 m"), std::string::npos);

    report.runs.erase(report.runs.begin()); // without one viewer there is nothing to relate to
    EXPECT_EQ(markdown(report, options).find("viewer alone"), std::string::npos);
    EXPECT_EQ(plot(report).find("Bistro"), std::string::npos);

    report.runs[0].server = {}; // what is not known is no number
    report.runs[0].server.cpu_s = NAN;
    EXPECT_TRUE(json(report, options)["runs"][0]["server"]["cpu_s"].is_null());
    EXPECT_NE(tableLine(report.runs[0]).find("| - | - |"), std::string::npos);
}

} // namespace
} // namespace brume::load
