// Starting, filling up, losing viewers and stopping; and every way in which starting fails.
#include <algorithm>
#include <csignal>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test {
namespace {

const Pose kPose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);

TEST(Lifecycle, AFullHouseRefusesAndAVanishedViewerFreesItsPlace) {
    RunningServer server({"--max-viewers", "1"});
    Watcher first(server.endpoint());
    first.look(kPose);
    ASSERT_TRUE(watch({&first}, [&] { return first.frames.size() >= 2; }));

    client::Session second(server.endpoint(), kSmall, kPatience);
    bool full = false;
    while (!second.closed())
        if (const auto message = second.next(milliseconds(100)))
            if (const auto* error = message->as<wire::Error>()) full = error->code() == wire::ErrorCode::full;
    EXPECT_TRUE(full) << second.closedBecause();
    EXPECT_FALSE(second.welcomed());
    EXPECT_GT(second.retryAfterSeconds(), 0);
    const size_t before = first.frames.size();
    EXPECT_TRUE(watch({&first}, [&] { return first.frames.size() >= before + 2; }));

    first.session.connection().vanish();
    // The server learns of a reset at once; a few tries, since that is still a race.
    bool welcomed = false;
    for (int attempt = 0; attempt < 50 && !welcomed; ++attempt) {
        client::Session again(server.endpoint(), kSmall, kPatience);
        while (!again.closed() && !again.welcomed()) again.next(milliseconds(100));
        welcomed = again.welcomed();
        if (!welcomed) std::this_thread::sleep_for(milliseconds(100));
    }
    EXPECT_TRUE(welcomed);
}

TEST(Lifecycle, SigtermSaysGoodbyeAndExitsWithZero) {
    RunningServer server;
    Watcher a(server.endpoint()), b(server.endpoint());
    a.look(kPose);
    b.look(kPose);
    ASSERT_TRUE(watch({&a, &b}, [&] { return !a.frames.empty() && !b.frames.empty(); }));
    server.process().signal(SIGTERM);
    EXPECT_TRUE(watch(
        {&a, &b}, [&] { return a.goodbye && b.goodbye; }, milliseconds(10'000)));
    EXPECT_EQ(server.process().exitCode(milliseconds(10'000)), 0) << server.process().err();
}

TEST(Lifecycle, SigtermDoesNotWaitForAViewerThatReadsNothing) {
    RunningServer server;
    Watcher deaf(server.endpoint());
    deaf.look(kPose);
    ASSERT_TRUE(watch({&deaf}, [&] { return !deaf.frames.empty(); }));
    server.process().signal(SIGINT); // Ctrl-C stops it in the same way
    EXPECT_EQ(server.process().exitCode(milliseconds(15'000)), 0) << server.process().err();
}

// Nothing goes on, and one line says what is wrong: `word` is in it.
void expectOneLine(const std::vector<std::string>& arguments, const std::string& word) {
    SCOPED_TRACE(word);
    const auto process = startServer(arguments);
    const auto code = process->exitCode();
    ASSERT_TRUE(code) << "it goes on: " << process->out();
    EXPECT_GT(*code, 0) << "exited with 0 or was ended by a signal";
    const std::string err = process->err();
    EXPECT_EQ(std::count(err.begin(), err.end(), '\n'), 1) << err;
    EXPECT_NE(err.find(word), err.npos) << err;
    EXPECT_EQ(process->out().find("listening"), std::string::npos);
}

TEST(Lifecycle, EveryBadStartEndsInOneClearLine) {
    expectOneLine({"--no-such-flag"}, "--no-such-flag");
    expectOneLine({"--port", "0", "--scene", "no-such-scene"}, "no-such-scene");
    expectOneLine({"--port", "0", "--scene", "/dev/null/scene.toml"}, "/dev/null/scene.toml");
    expectOneLine({"--port", "70000"}, "port");
    expectOneLine({"--port", "0", "--max-viewers", "-1"}, "max-viewers");
}

TEST(Lifecycle, ATakenPortEndsInOneClearLine) {
    RunningServer server;
    const std::string port = std::to_string(server.port());
    expectOneLine({"--scene", "cloud", "--port", port}, port);
    Watcher watcher(server.endpoint()); // the first one goes on
    watcher.look(kPose);
    EXPECT_TRUE(watch({&watcher}, [&] { return !watcher.frames.empty(); }));
}

TEST(Lifecycle, HelpAndVersion) {
    for (const std::string flag : {"--help", "--version"}) {
        const auto process = startServer({flag});
        EXPECT_EQ(process->exitCode(), 0);
        EXPECT_NE(process->out().find(flag == "--help" ? "--scene" : "brume-server"), std::string::npos) << process->out();
        EXPECT_EQ(process->err(), "");
    }
}

} // namespace
} // namespace brume::test
