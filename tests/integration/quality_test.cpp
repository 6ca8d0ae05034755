// What viewers get of the device: finer pictures where there is time, and their own part of it where there is not.
#include <algorithm>
#include <fstream>
#include <regex>
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <turbojpeg.h>

#include "tests/integration/cluster_node.h"
#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

// Of a JPEG: TJSAMP_420, TJSAMP_444.
int samplingOf(const client::Bytes& jpeg) {
    const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
    int width = 0, height = 0, sampling = -1, colours = 0;
    tjDecompressHeader3(decoder.get(), reinterpret_cast<const unsigned char*>(jpeg.data()),
                        static_cast<unsigned long>(jpeg.size()), &width, &height, &sampling, &colours);
    return sampling;
}

bool lastIsPng(const Watcher& watcher) { return !watcher.frames.empty() && client::isPng(watcher.last().jpegs[0]); }

TEST(RestingPicture, ComesFinerThenWithoutLossThenNotAtAll) {
    RunningServer server({"--paused", "--frame-budget", "10000"}); // ms: nothing is given up
    Watcher watcher(server.endpoint());
    watcher.look(kFromFront);
    ASSERT_TRUE(watch({&watcher}, [&] { return lastIsPng(watcher); }));
    const auto before = watcher.frames.size();
    ASSERT_GE(before, 3u);
    const Seen &first = watcher.frames[before - 3], &fine = watcher.frames[before - 2], &whole = watcher.last();
    EXPECT_EQ(first.quality, kSmall.quality);
    EXPECT_EQ(samplingOf(first.jpegs[0]), TJSAMP_420);
    EXPECT_EQ(fine.quality, 90);
    EXPECT_EQ(samplingOf(fine.jpegs[0]), TJSAMP_444);
    EXPECT_EQ(whole.quality, 100);
    EXPECT_LT(whole.jpegs[0].size(), size_t{4} << 20);
    EXPECT_EQ(whole.state_hash, fine.state_hash);
    // JPEG of quality 90 is two levels off in the mean at most; the coarser one is another rendering, too.
    const auto a = decoded(fine.jpegs[0], 320, 180), b = decoded(whole.jpegs[0], 320, 180);
    double sum = 0;
    for (size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(int(a.rgb[i]) - int(b.rgb[i]));
    EXPECT_LT(sum / double(a.rgb.size()), 2);
    EXPECT_GT(contrast(b), 8);

    watch(
        {&watcher}, [] { return false; }, milliseconds(1000));
    EXPECT_EQ(watcher.frames.size(), before); // nothing more
    watcher.look(lookAt({1, 2, 26}, {0, 0, 0}, 0.8f));
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() > before; }));
    EXPECT_EQ(watcher.frames[before].quality, kSmall.quality);
}

TEST(RestingPicture, NoPngForWhoDoesNotReadIt) {
    RunningServer server({"--paused", "--frame-budget", "10000"});
    client::Wishes wishes = kSmall;
    wishes.lossless = false;
    Watcher watcher(server.endpoint(), wishes);
    watcher.look(kFromFront);
    ASSERT_TRUE(watch({&watcher}, [&] { return !watcher.frames.empty() && watcher.last().quality == 90; }));
    watch(
        {&watcher}, [] { return false; }, milliseconds(1000));
    for (const Seen& frame : watcher.frames) EXPECT_FALSE(client::isPng(frame.jpegs[0]));
    EXPECT_EQ(watcher.last().quality, 90);
}

// The camera rests, the medium moves.
TEST(MovingMedium, IsDrawnFinerWhereThereIsTime) {
    BRUME_WHOLE_LAYER_ONLY();
    const auto finer = [](const std::vector<std::string>& options) {
        RunningServer server(options);
        Watcher watcher(server.endpoint(), {.width = 64, .height = 36, .views = 1, .quality = 80});
        watcher.look(kFromFront);
        if (!watch({&watcher}, [&] { return watcher.frames.size() >= 60; })) ADD_FAILURE() << "60 frames did not come";
        return metric(server.port(), "brume_finer_batches_total").value_or(-1);
    };
    EXPECT_GT(finer({"--frame-budget", "10000"}), 0);
    EXPECT_EQ(finer({"--frame-budget", "10000", "--refine-moving", "0"}), 0);
    EXPECT_EQ(finer({"--frame-budget", "1"}), 0); // ms: no time
}

// One pose is enough for as long as the camera rests: its age is nothing that frames waited for, and they come no
// slower for it.
TEST(MovingMedium, KeepsItsRateWhileTheCameraRests) {
    RunningServer server;
    Watcher watcher(server.endpoint(), {.width = 64, .height = 36, .views = 1, .quality = 80});
    watcher.look(kFromFront);
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() >= 120; }));
    const auto viewer = nlohmann::json::parse(get(server.port(), "/viewers").body)["viewers"][0];
    EXPECT_LT(viewer["stages_ms"]["wait"]["p99"], 1000);
    EXPECT_LE(viewer["window_frames"], 4); // as a link without delay needs, not as frames seconds old would
}

// One large stereo picture, by the dearest method, beside four small ones. In one batch all would come as often as it
// does.
TEST(Fairness, ADearViewerDoesNotTakeTheOthersRate) {
    BRUME_WHOLE_LAYER_ONLY();
    RunningServer server({"--frame-budget", "20", "--set", "render.error=0.003", "--set", "render.method=sphere"});
    Watcher dear(server.endpoint(), {.width = 1280, .height = 720, .views = 2, .quality = 50});
    std::vector<std::unique_ptr<Watcher>> small;
    std::vector<Watcher*> all{&dear};
    for (int i = 0; i < 4; ++i) {
        small.push_back(std::make_unique<Watcher>(
            server.endpoint(), client::Wishes{.width = 64, .height = 36, .views = 1, .quality = 50}));
        all.push_back(small.back().get());
    }
    for (size_t i = 0; i < all.size(); ++i) all[i]->look(lookAt({float(i), 2, 26}, {0, 0, 0}, 0.8f));
    ASSERT_TRUE(watch(
        all, [&] { return std::all_of(all.begin(), all.end(), [](Watcher* w) { return w->frames.size() >= 3; }); },
        milliseconds(60'000)));
    std::vector<size_t> before;
    for (const Watcher* watcher : all) before.push_back(watcher->frames.size());
    watch(
        all, [] { return false; }, milliseconds(5000));
    const size_t of_dear = dear.frames.size() - before[0];
    EXPECT_GE(of_dear, 3u); // it does not starve
    for (size_t i = 1; i < all.size(); ++i) EXPECT_GT(all[i]->frames.size() - before[i], 2 * of_dear) << i;
    const auto viewers = nlohmann::json::parse(get(server.port(), "/viewers").body)["viewers"];
    ASSERT_EQ(viewers.size(), 5u);
    for (const auto& viewer : viewers) {
        EXPECT_GT(viewer["frames_per_second"], 0);
        EXPECT_GT(viewer["stages_ms"]["render"]["p50"], 0);
        EXPECT_LE(viewer["stages_ms"]["render"]["p50"], viewer["stages_ms"]["render"]["p95"]);
        EXPECT_LE(viewer["stages_ms"]["render"]["p95"], viewer["stages_ms"]["render"]["p99"]);
        EXPECT_GE(viewer["window_frames"], 2);
        EXPECT_GT(viewer["frames"]["sent"], 0);
    }
    EXPECT_EQ(viewers[0]["size"], nlohmann::json({1280, 720}));
    EXPECT_EQ(viewers[0]["eyes"], 2);
}

// Every metric that docs/operate.md names is there once a viewer has had frames whose error was measured, and somebody
// was refused.
TEST(Metrics, AllThatAreDocumentedAreThere) {
    std::ifstream in("docs/operate.md"); // tests run in the source folder
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const size_t begin = text.find("## Metrics"), end = text.find("\n## ", begin + 1);
    ASSERT_NE(end, text.npos);
    const std::string section = text.substr(begin, end - begin);

    const NatsServer nats; // a server of a cluster has all of them
    RunningServer server(inCluster(nats, {"--measure-error", "1"}));
    Watcher watcher(server.endpoint());
    watcher.look(kFromFront);
    const auto measured = [&] { return watcher.frames.size() >= 5 && watcher.last().measured > 0; };
    ASSERT_TRUE(watch({&watcher}, measured, milliseconds(60'000)));
    const uint64_t tick = watcher.last().tick;
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.state_tick > tick; })); // metrics have the report's errors
    HttpConnection other(server.port());
    other.send("GET /ws HTTP/1.1\r\nHost: 127.0.0.1\r\nOrigin: https://elsewhere.example\r\nConnection: "
               "Upgrade\r\nUpgrade: websocket\r\n"
               "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: "
               "brume.v1\r\n\r\n");
    EXPECT_EQ(other.readReply().status, 403);
    const std::string there = get(server.port(), "/metrics").body;

    std::set<std::string> named;
    const std::regex name("`((?:brume|process)_[a-z_]+)");
    for (std::sregex_iterator i(section.begin(), section.end(), name), last; i != last; ++i) named.insert((*i)[1]);
    EXPECT_GE(named.size(), 20u);
    for (const std::string& one : named) EXPECT_NE(there.find("# TYPE " + one + " "), there.npos) << one;
    // And the other way round: what is there is documented.
    const std::regex type("# TYPE ((?:brume|process)_[a-z_]+) ");
    for (std::sregex_iterator i(there.begin(), there.end(), type), last; i != last; ++i)
        EXPECT_TRUE(named.contains((*i)[1])) << (*i)[1];
}

} // namespace
} // namespace brume::test
