// brume-client at a server whose scene stands still: the network server with a made-up frame loop.
#include <csignal>
#include <filesystem>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "tests/integration/program.h"
#include "tests/net/fixture.h"

namespace brume::test {
namespace {

class Standstill : public ServerTest {
protected:
    void standStill(const std::string& why) {
        auto report = std::make_shared<SceneReport>(*audience->report());
        report->standstill = why;
        audience->publish(std::move(report));
    }
};

TEST_F(Standstill, TheClientSaysSoOnceAndStays) {
    const uint16_t port = serve();
    pauseRenderer(); // no tick, no frame
    standStill("no word\nfrom the log");
    const auto out = std::filesystem::temp_directory_path() / ("brume-standstill-" + std::to_string(getpid()));
    const auto client = startProgram(BRUME_CLIENT, {"--headless", "--url", "ws://127.0.0.1:" + std::to_string(port),
                                                    "--timeout", "2", "--out", out.string(), "--no-save"});
    const std::string line = "brume-client: the scene stands still: no word?from the log\n";
    EXPECT_TRUE(eventually([&] { return client->err() == line; }, kPatience)) << client->err();
    // The server tells it once a second: four times is longer than the client's patience with frames that do not come.
    const auto other = watch();
    for (int i = 0; i < 5; ++i) {
        const auto state = other->next<wire::SceneState>();
        ASSERT_TRUE(state);
        ASSERT_TRUE(state->parsed->as<wire::SceneState>()->standstill());
    }
    client->signal(SIGINT);
    EXPECT_EQ(client->exitCode(), 0) << client->err();
    EXPECT_EQ(client->err(), line) << "it neither lost the connection nor said it again";
    EXPECT_EQ(nlohmann::json::parse(contentOf(out / "stats.json"))["connections"], 1);
    std::filesystem::remove_all(out);
}

} // namespace
} // namespace brume::test
