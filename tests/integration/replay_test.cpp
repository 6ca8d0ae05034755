// A recorded session that viewers look at, and as a film.
#include <csignal>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/integration/http.h"
#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test {
namespace {

const Pose kFront = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), kSide = lookAt({24, 3, 0}, {0, 0, 0}, 0.8f);

HttpReply post(uint16_t port, const std::string& target) {
    HttpConnection connection(port);
    connection.send("POST " + target + " HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 0\r\n\r\n");
    return connection.readReply();
}

class Look : public testing::Test {
protected:
    static inline const std::filesystem::path file_ =
        std::filesystem::temp_directory_path() / ("brume-look-" + std::to_string(getpid()));
    static inline std::map<uint64_t, uint64_t> hashes_; // state by tick, as viewers of the session were told
    static inline uint64_t last_ = 0;                   // the last of these ticks

    // Two seconds and more of pushes.
    static void SetUpTestSuite() {
        RunningServer server({"--record", file_.string(), "--set", "medium.seed=11"});
        Watcher watcher(server.endpoint());
        watcher.look(kFront);
        for (int i = 0; i < 6; ++i) {
            watcher.session.sendImpulse({{0, 0, 26}, {0.01f * float(i), 0, -1}, {0, 0, 0}, 3});
            const size_t frames = watcher.frames.size();
            ASSERT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() >= frames + 2; }));
        }
        ASSERT_TRUE(watch({&watcher}, [&] { return watcher.last().tick >= 120; }));
        server.process().signal(SIGTERM);
        ASSERT_EQ(server.process().exitCode(), 0);
        hashes_ = watcher.hashes;
        last_ = hashes_.rbegin()->first;
    }
    static void TearDownTestSuite() { std::filesystem::remove(file_); }

    static std::string hashAt(uint64_t tick) { return fmt::format("{:016x}", hashes_.at(tick)); }
};

TEST_F(Look, ViewersSeeTheRecordedSessionAgain) {
    RunningServer server({"--replay", file_.string(), "--look"});
    Watcher watcher(server.endpoint());
    watcher.look(kFront);
    size_t common = 0;
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() >= 5 && watcher.last().tick >= last_; }));
    for (const auto& [tick, hash] : watcher.hashes)
        if (const auto then = hashes_.find(tick); then != hashes_.end()) {
            ++common;
            EXPECT_EQ(hash, then->second) << "tick " << tick;
        }
    EXPECT_GE(common, 2u);

    // It ends, and the server does not: the camera still moves.
    const std::string end = ": the scene stands still";
    ASSERT_TRUE(watch({&watcher}, [&] { return server.process().err().find(end) != std::string::npos; }));
    const uint32_t pose = watcher.look(kSide);
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.last().pose_seq == pose; }));
    const uint64_t tick = watcher.last().tick;
    EXPECT_GE(tick, last_);
    const HttpReply snapshot = get(server.port(), "/snapshot.jpg?w=64&h=36");
    EXPECT_EQ(snapshot.status, 200);
    EXPECT_EQ(snapshot.headers.at("brume-tick"), std::to_string(tick));

    // And is seen once more, from the start.
    EXPECT_EQ(post(server.port(), "/seek?tick=0").status, 200);
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.last().tick < tick; }));
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.last().tick == tick; }));
    EXPECT_EQ(timesIn(server.process().err(), end), 1u) << server.process().err();
    EXPECT_EQ(server.process().err().find("difference"), std::string::npos) << server.process().err();
    server.process().signal(SIGTERM);
    EXPECT_EQ(server.process().exitCode(), 0);
}

TEST_F(Look, ItPausesSeeksAndTakesNothingElse) {
    RunningServer server({"--replay", file_.string(), "--look"});
    Watcher watcher(server.endpoint());
    watcher.look(kFront);
    const HttpReply paused = post(server.port(), "/pause");
    EXPECT_EQ(paused.status, 200);
    const std::string tick = paused.headers.at("brume-tick");
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.paused == true; }));
    EXPECT_EQ(post(server.port(), "/pause").headers.at("brume-tick"), tick) << "it stands";

    // To a tick that viewers of the session were told of, forward and back.
    for (const uint64_t to :
         {last_, hashes_.begin()->first, std::next(hashes_.begin(), ptrdiff_t(hashes_.size() / 2))->first}) {
        const HttpReply sought = post(server.port(), fmt::format("/seek?tick={}", to));
        ASSERT_EQ(sought.status, 200) << sought.body;
        EXPECT_EQ(sought.headers.at("brume-tick"), std::to_string(to));
        EXPECT_EQ(sought.headers.at("brume-state"), hashAt(to));
        ASSERT_TRUE(watch({&watcher}, [&] { return !watcher.frames.empty() && watcher.last().tick == to; }));
        EXPECT_EQ(get(server.port(), "/snapshot.png?w=64&h=36").headers.at("brume-state"), hashAt(to));
        EXPECT_EQ(post(server.port(), "/pause").headers.at("brume-tick"), std::to_string(to));
        const HttpReply particles = get(server.port(), "/particles.ply"); // numbered files of a recording
        EXPECT_NE(particles.headers.at("content-disposition").find(fmt::format("-{:06}.ply", to)), std::string::npos);
    }
    for (const char* wrong : {"/seek", "/seek?tick=", "/seek?tick=-1", "/seek?tick=1x", "/seek?tick=1&x=2",
                              "/seek?tick=99999999", "/seek?tick=99999999999999999999"}) {
        const HttpReply refused = post(server.port(), wrong);
        EXPECT_EQ(refused.status, 400) << wrong;
        EXPECT_EQ(refused.body.find("which tick? /seek?tick=N, N from 0 to "), 0u) << refused.body;
    }
    EXPECT_EQ(get(server.port(), "/seek?tick=1").status, 405);
    EXPECT_EQ(post(server.port(), "/scene?name=cumulus").status, 409);

    watcher.session.sendImpulse({{0, 0, 26}, {0, 0, -1}, {0, 0, 0}, 3});
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.errors.size() == 1; }));
    EXPECT_EQ(watcher.errors[0].text, "this is a replay: pause it, resume it, or POST /seek?tick=N");
    const uint64_t stood = watcher.last().tick;
    setPaused(watcher, false);
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.last().tick > stood; }));
    setPaused(watcher, true);
    EXPECT_EQ(post(server.port(), "/resume").status, 200);
    EXPECT_EQ(watcher.errors.size(), 1u);
}

TEST_F(Look, AFileThatWasReplacedIsToldOfAndEndsNothing) {
    const std::filesystem::path copy = file_.string() + "-copy";
    std::filesystem::copy_file(file_, copy);
    RunningServer server({"--replay", copy.string(), "--look"});
    ASSERT_EQ(post(server.port(), "/pause").status, 200);
    const std::string there = post(server.port(), fmt::format("/seek?tick={}", last_)).headers.at("brume-tick");
    std::filesystem::remove(copy); // the server still has the old file open
    std::ofstream(copy) << "something else\n";
    const HttpReply refused = post(server.port(), "/seek?tick=1");
    EXPECT_EQ(refused.status, 500);
    EXPECT_EQ(refused.body.find("still at tick " + there), 0u) << refused.body;
    EXPECT_EQ(get(server.port(), "/snapshot.png?w=64&h=36").headers.at("brume-state"), hashAt(last_));
    server.process().signal(SIGTERM);
    EXPECT_EQ(server.process().exitCode(), 0) << server.process().err();
}

TEST_F(Look, AServerThatIsNoReplayDoesNotSeek) {
    RunningServer server;
    EXPECT_EQ(post(server.port(), "/seek?tick=1").status, 409);
}

TEST_F(Look, AFilmHasAPictureForEachOfItsTimes) {
    const std::filesystem::path folder = file_.string() + "-film";
    for (const std::string format : {"jpeg", "png"}) {
        const auto film = startServer({"--replay", file_.string(), "--out", folder.string(), "--out-fps", "5",
                                       "--out-height", "90", "--out-format", format});
        ASSERT_EQ(film->exitCode(), 0) << film->err();
        std::vector<std::filesystem::path> files;
        const std::string ending = format == "jpeg" ? ".jpg" : ".png";
        for (const auto& entry : std::filesystem::directory_iterator(folder))
            if (entry.path().extension() == ending) files.push_back(entry.path());
        std::sort(files.begin(), files.end());
        const uint64_t ticks = std::stoull(film->out().substr(film->out().find("replayed ") + 9));
        ASSERT_EQ(files.size(), ticks / 12 + 1) << film->out();
        EXPECT_EQ(files.front().filename(), "000000" + ending);
        EXPECT_NE(film->err().find(fmt::format("{} of {} pictures", files.size(), files.size())), std::string::npos)
            << film->err();
        if (format == "jpeg") {
            const client::Picture first = decoded(contentOf(files.front()), 160, 90),
                                  last = decoded(contentOf(files.back()), 160, 90);
            EXPECT_GT(contrast(first), 8);
            EXPECT_GT(difference(first, last), 0.1);
        } else {
            EXPECT_EQ(contentOf(files.back())[1], 'P');
        }
    }
    std::filesystem::remove_all(folder);
    expectOneLine(*startServer({"--replay", file_.string(), "--out", "/proc/none"}), "/proc/none: no folder");
    const auto both = startServer({"--replay", file_.string(), "--out", folder.string(), "--look"});
    expectOneLine(*both, "--look and --out");
    expectOneLine(*startServer({"--look"}), "--look: nothing to look at; allowed: with --replay FILE");
    expectOneLine(*startServer({"--out", folder.string()}), "--out: nothing to make a film of");
}

} // namespace
} // namespace brume::test
