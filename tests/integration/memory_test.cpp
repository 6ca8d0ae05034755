// A server whose address space has a limit lives, or ends in one line.
#include <algorithm>
#include <csignal>

#include <gtest/gtest.h>

#include "tests/integration/http.h"
#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test {
namespace {

Pose fromFront() { return lookAt({0, 2, 26}, {0, 0, 0}, 0.8f); }

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

// Viewers with pictures of every shape, until all have an answer or the server has ended. Returns how many got a
// picture.
int besiege(uint16_t port, Process& server) {
    constexpr std::pair<uint16_t, uint16_t> kShapes[] = {{7680, 540}, {540, 7680}, {2560, 1440}, {64, 36}};
    std::vector<std::unique_ptr<Watcher>> watchers;
    try {
        for (const auto& [width, height] : kShapes) {
            watchers.push_back(
                std::make_unique<Watcher>(client::Endpoint{"127.0.0.1", port, "/ws"},
                                          client::Wishes{.width = width, .height = height, .views = 2, .quality = 90}));
            watchers.back()->look(fromFront());
        }
        std::vector<Watcher*> all;
        for (const auto& watcher : watchers) all.push_back(watcher.get());
        watch(
            all,
            [&] {
                return server.exitCode(milliseconds(0)) ||
                       std::all_of(all.begin(), all.end(), [](const Watcher* watcher) {
                           return !watcher->frames.empty() || watcher->goodbye || !watcher->errors.empty();
                       });
            },
            milliseconds(20'000));
    } catch (const std::runtime_error&) { // refused, or the server has ended: the caller looks
    }
    return int(
        std::count_if(watchers.begin(), watchers.end(), [](const auto& watcher) { return !watcher->frames.empty(); }));
}

void expectLineOfItsOwn(const std::string& err) {
    EXPECT_NE(err.find("brume-server: "), err.npos) << err;
    EXPECT_EQ(err.find("terminate called"), err.npos) << err;
}

// From too little to start with to enough for all: it answers, or it has ended by itself and has said why.
TEST(MemoryTest, AServerWithLittleAddressSpaceLivesOrEndsInOneLine) {
    int ended = 0, lived = 0, served = 0;
    for (const unsigned mebibytes : {500u, 1200u, 4000u}) {
        SCOPED_TRACE(std::to_string(mebibytes) + " MiB");
        const auto server =
            limited(mebibytes, {"--max-pixels", "4147200", "--most-frame-time", "60000", "--frame-budget", "10000"});
        if (const auto port = server->lineStarting("listening on http://127.0.0.1:")) {
            const auto number = uint16_t(std::stoi(*port));
            served += besiege(number, *server);
            if (!server->exitCode(milliseconds(0))) {
                EXPECT_TRUE(metric(number, "brume_picture_memory_bytes"));
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
    RunningServer server({"--picture-memory", "16", "--most-frame-time", "60000", "--frame-budget", "10000"});
    Watcher modest(server.endpoint()), greedy(server.endpoint(), {.width = 1920, .height = 1080, .views = 1});
    modest.look(fromFront());
    greedy.look(fromFront());
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
