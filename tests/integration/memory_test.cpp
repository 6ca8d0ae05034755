// A server whose address space has a limit lives, or ends in one line.
#include <algorithm>
#include <csignal>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/integration/http.h"
#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"

namespace brume::test {
namespace {

// A server that may use `mebibytes` of address space.
std::unique_ptr<Process> limited(unsigned mebibytes, const std::vector<std::string>& arguments) {
    std::vector<std::string> command{"-c",
                                     "ulimit -v $0; exec \"$@\"",
                                     std::to_string(mebibytes << 10),
                                     BRUME_SERVER,
                                     "--scene",
                                     "props",
                                     "--ahead",
                                     "off",
                                     "--port",
                                     "0"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return startProgram("/bin/sh", command);
}

// The worst mix: viewers of two eyes with pictures of every shape, which change their sizes, beside snapshots and
// streams. Ends when all viewers have an answer and all snapshots a reply, or the server has ended. Returns how many
// viewers got a picture.
int besiege(uint16_t port, Process& server) {
    constexpr std::pair<uint16_t, uint16_t> kShapes[] = {{7680, 540}, {540, 7680}, {2560, 1440}, {64, 36}};
    std::vector<std::unique_ptr<Watcher>> watchers;
    std::vector<std::unique_ptr<HttpConnection>> snapshots, streams;
    const auto ended = [&] { return server.exitCode(milliseconds(0)).has_value(); };
    try {
        for (int i = 0; i < 3; ++i) {
            snapshots.push_back(std::make_unique<HttpConnection>(port));
            snapshots.back()->send(fmt::format("GET /snapshot.png?w=2560&h=1440&position={},2,26 HTTP/1.1\r\n"
                                               "Host: localhost\r\nConnection: close\r\n\r\n",
                                               i));
            streams.push_back(std::make_unique<HttpConnection>(port));
            streams.back()->send(fmt::format("GET /stream.mjpg?w=1920&h=1080&position={},3,26 HTTP/1.1\r\n"
                                             "Host: localhost\r\n\r\n",
                                             i));
        }
        for (const auto& [width, height] : kShapes) {
            watchers.push_back(
                std::make_unique<Watcher>(client::Endpoint{"127.0.0.1", port, "/ws"},
                                          client::Wishes{.width = width, .height = height, .views = 2, .quality = 90}));
            watchers.back()->look(kFromFront);
        }
        std::vector<Watcher*> all;
        for (const auto& watcher : watchers) all.push_back(watcher.get());
        const auto answered = [&] {
            return ended() || std::all_of(all.begin(), all.end(), [](const Watcher* watcher) {
                       return !watcher->frames.empty() || watcher->goodbye || !watcher->errors.empty();
                   });
        };
        watch(all, answered, milliseconds(20'000));
        for (size_t turn = 1; turn < std::size(kShapes) && !ended(); ++turn) {
            const auto count = [&] {
                size_t frames = 0;
                for (const Watcher* watcher : all) frames += watcher->frames.size();
                return frames;
            };
            const size_t before = count();
            for (size_t i = 0; i < all.size(); ++i) {
                const auto& [width, height] = kShapes[(i + turn) % std::size(kShapes)];
                if (!all[i]->session.closed()) all[i]->session.sendPose(kFromFront, width, height);
            }
            watch(
                all, [&] { return ended() || count() >= before + all.size(); }, milliseconds(3'000));
        }
        for (const auto& one : snapshots) {
            const int status = one->readHead().status;
            EXPECT_TRUE(status == 200 || status == 400 || status == 503) << status;
        }
    } catch (const std::runtime_error&) { // refused, or the server has ended: the caller looks
    }
    return int(
        std::count_if(watchers.begin(), watchers.end(), [](const auto& watcher) { return !watcher->frames.empty(); }));
}

// False: the server has ended, or is about to.
bool answers(uint16_t port) {
    try {
        return metric(port, "brume_picture_memory_bytes").has_value();
    } catch (const std::runtime_error&) {
        return false;
    }
}

void expectLineOfItsOwn(const std::string& err) {
    EXPECT_NE(err.find("brume-server: "), err.npos) << err;
    EXPECT_EQ(err.find("terminate called"), err.npos) << err;
}

// From too little to start with to enough for all: it answers, or it has ended by itself and has said why.
// Never by a signal, and never in silence.
TEST(MemoryTest, AServerWithLittleAddressSpaceLivesOrEndsInOneLine) {
    BRUME_WHOLE_LAYER_ONLY();
    int ended = 0, lived = 0, served = 0;
    for (const unsigned mebibytes : {500u, 800u, 1000u, 1200u, 1500u, 4000u}) {
        SCOPED_TRACE(std::to_string(mebibytes) + " MiB");
        const auto server =
            limited(mebibytes, {"--max-pixels", "4147200", "--most-frame-time", "60000", "--frame-budget", "10000"});
        if (const auto port = server->lineStarting("listening on http://127.0.0.1:")) {
            const auto number = uint16_t(std::stoi(*port));
            served += besiege(number, *server);
            if (answers(number)) {
                ++lived;
                server->signal(SIGTERM);
                EXPECT_EQ(server->exitCode(), 0) << server->err();
                continue;
            }
        }
        ++ended;
        EXPECT_EQ(server->exitCode(), 1) << server->err();
        expectLineOfItsOwn(server->err());
    }
    EXPECT_GE(ended, 1);
    EXPECT_GE(lived, 1);
    EXPECT_GE(served, 1);
}

// More than --picture-memory: the viewer gets its line, and others go on.
TEST(MemoryTest, PicturesBeyondTheirBudgetAreRefusedAndNobodyElse) {
    RunningServer server({"--picture-memory", "16", "--frame-budget", "10000"});
    Watcher modest(server.endpoint()), greedy(server.endpoint(), {.width = 1920, .height = 1080, .views = 1});
    modest.look(kFromFront);
    greedy.look(kFromFront);
    EXPECT_TRUE(watch({&modest, &greedy}, [&] { return greedy.goodbye || !greedy.errors.empty(); }));
    EXPECT_TRUE(greedy.frames.empty());
    const size_t before = modest.frames.size();
    EXPECT_TRUE(watch({&modest}, [&] { return modest.frames.size() > before + 2; }));
    EXPECT_LE(metric(server.port(), "brume_picture_memory_bytes").value_or(1e9), 16 << 20);
    const std::string said = server.process().out() + server.process().err();
    EXPECT_NE(said.find("--picture-memory"), said.npos) << said;
}

} // namespace
} // namespace brume::test
