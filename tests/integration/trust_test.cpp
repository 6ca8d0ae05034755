// The real programs: who is let in, what the start refuses, and the clients over TLS.
#include <csignal>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <unistd.h>

#include "tests/integration/http.h"
#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/net/certificate.h"

namespace brume::test {
namespace {

namespace fs = std::filesystem;

class Trust : public testing::Test {
protected:
    const fs::path folder = fs::temp_directory_path() / ("brume-trust-" + std::to_string(getpid()));
    const std::string key = (folder / "token.key").string();

    void SetUp() override {
        fs::create_directory(folder);
        write(key, std::string(32, 'k'));
    }
    void TearDown() override { fs::remove_all(folder); }

    static void write(const std::string& file, const std::string& text) {
        std::ofstream(file, std::ios::binary) << text;
        fs::permissions(file, fs::perms(0600));
    }
    // Made by the program itself.
    std::string token(const std::string& role, const std::string& seconds = "600") const {
        const auto process = startServer({"--token-key", key, "--make-token", role, "--valid-for", seconds});
        EXPECT_EQ(process->exitCode(), 0) << process->err();
        std::string text = process->out();
        EXPECT_TRUE(text.ends_with('\n'));
        text.pop_back();
        return text;
    }
    static client::Endpoint with(client::Endpoint server, const std::string& token) {
        server.token = token;
        return server;
    }
    static std::string whyNot(const client::Endpoint& server) {
        try {
            Watcher watcher(server);
            return "";
        } catch (const std::runtime_error& error) {
            return error.what();
        }
    }
};

TEST_F(Trust, OffLoopbackTheServerDoesNotStartWithoutAKeyOrOpen) {
    for (const char* listen : {"0.0.0.0", "::", "192.0.2.1"}) {
        const auto process = startServer({"--port", "0", "--listen", listen});
        expectOneLine(*process, "allowed: --token-key FILE for viewers with tokens, or --open for whoever comes");
    }
    expectOneLine(*startServer({"--open", "--token-key", key}), "give one of them");
    expectOneLine(*startServer({"--tls-key", key}), "--tls-certificate and --tls-key belong together");
    expectOneLine(*startServer({"--make-token", "viewer"}), "--make-token needs --token-key");
    expectOneLine(*startServer({"--token-key", key, "--make-token", "king"}), "viewer");
    expectOneLine(*startServer({"--token-key", key, "--make-token", "viewer", "--valid-for", "86401"}), "--valid-for");
    write(key, "short");
    expectOneLine(*startServer({"--token-key", key}), "32 to 4096 bytes");
    expectOneLine(*startServer({"--token-key", (folder / "none").string()}), "there is no such file");
}

TEST_F(Trust, OpenIsDeliberateAndTheLogWarns) {
    const auto process = startServer({"--port", "0", "--listen", "0.0.0.0", "--scene", "cloud", "--open"});
    ASSERT_TRUE(process->lineStarting("listening on http://0.0.0.0:")) << process->err();
    process->signal(SIGTERM);
    EXPECT_EQ(process->exitCode(), 0); // and all of its log is read, which is another pipe
    EXPECT_NE(process->err().find("open: everyone who can reach 0.0.0.0"), std::string::npos) << process->err();
}

TEST_F(Trust, ClientsComeInWithTheirTokenAndDoWhatItAllows) {
    RunningServer server({"--token-key", key});
    EXPECT_NE(whyNot(server.endpoint()).find("401 Unauthorized: a token is needed"), std::string::npos);
    EXPECT_NE(whyNot(with(server.endpoint(), "x.y")).find("not made with this server's key"), std::string::npos);

    Watcher viewer(with(server.endpoint(), token("viewer"))), chief(with(server.endpoint(), token("operator")));
    viewer.look(lookAt({0, 2, 26}, {0, 0, 0}, 0.8f));
    EXPECT_TRUE(watch({&viewer}, [&] { return !viewer.frames.empty(); }));
    viewer.session.sendPaused(true);
    EXPECT_TRUE(watch({&viewer}, [&] { return viewer.saw(wire::ErrorCode::forbidden); }));
    chief.session.sendPaused(true);
    EXPECT_TRUE(watch({&chief, &viewer}, [&] { return viewer.paused == true; }));
    // Nobody's token is in the log.
    EXPECT_EQ(server.process().err().find("eyJ"), std::string::npos);
}

TEST_F(Trust, TheProgramsTakeATokenOfAFileOrOfTheEnvironment) {
    RunningServer server({"--token-key", key});
    const std::string file = (folder / "token").string();
    write(file, token("operator") + "\n");
    const std::vector<std::string> once{"--headless", "--url", server.url(), "--frames", "2", "--size", "64x64"};
    auto arguments = once;
    arguments.insert(arguments.end(), {"--token-file", file});
    const auto by_file = startProgram(BRUME_CLIENT, arguments);
    EXPECT_EQ(by_file->exitCode(), 0) << by_file->err();
    const auto by_environment = startProgram(BRUME_CLIENT, once, {"BRUME_TOKEN=" + token("viewer")});
    EXPECT_EQ(by_environment->exitCode(), 0) << by_environment->err();
    const auto none = startProgram(BRUME_CLIENT, once);
    expectOneLine(*none, "401 Unauthorized: a token is needed");

    const std::vector<std::string> load{"--server",  server.url(), "--viewers", "2",
                                        "--seconds", "0.5",        "--warm-up", "0"};
    arguments = load;
    arguments.insert(arguments.end(), {"--token-file", file});
    const auto crowd = startProgram(BRUME_LOAD, arguments);
    EXPECT_EQ(crowd->exitCode(), 0) << crowd->err();
    expectOneLine(*startProgram(BRUME_LOAD, load, {"BRUME_TOKEN=" + token("viewer")}), "403");
}

TEST_F(Trust, ClientsVerifyTheServersCertificate) {
    Certificate certificate;
    const auto process = startServer({"--port", "0", "--listen", "0.0.0.0", "--open", "--scene", "cloud",
                                      "--tls-certificate", certificate.certificate(), "--tls-key", certificate.key()});
    const auto port = process->lineStarting("listening on https://0.0.0.0:");
    ASSERT_TRUE(port) << process->err();
    client::Endpoint server = client::parseUrl("wss://127.0.0.1:" + *port);
    EXPECT_NE(whyNot(server).find("its certificate is not trusted"), std::string::npos) << whyNot(server);
    client::Endpoint plain = server;
    plain.tls = false;
    EXPECT_NE(whyNot(plain).find("400 Bad Request: this port speaks TLS"), std::string::npos) << whyNot(plain);
    server.ca = certificate.certificate();
    Watcher watcher(server);
    watcher.look(lookAt({0, 2, 26}, {0, 0, 0}, 0.8f));
    EXPECT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() >= 3; })) << watcher.session.closedBecause();
    client::Endpoint other = server; // the right certificate, of another name
    other.host = "127.0.0.2";
    EXPECT_NE(whyNot(other).find("its certificate is not trusted"), std::string::npos) << whyNot(other);

    const auto crowd = startProgram(BRUME_LOAD, {"--server", server.url(), "--ca", server.ca, "--viewers", "2",
                                                 "--seconds", "0.5", "--warm-up", "0", "--decode"});
    EXPECT_EQ(crowd->exitCode(), 0) << crowd->err();

    // Renewed while it runs: the open session goes on, the next gets the new one.
    certificate.renew();
    process->signal(SIGHUP);
    EXPECT_TRUE(watch({&watcher}, [&] { return whyNot(server).empty(); }));
    const size_t before = watcher.frames.size();
    EXPECT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() > before; }));
    process->signal(SIGTERM);
    EXPECT_TRUE(watch({&watcher}, [&] { return watcher.goodbye.has_value(); })) << "said over TLS";
    EXPECT_EQ(process->exitCode(), 0);
}

} // namespace
} // namespace brume::test
