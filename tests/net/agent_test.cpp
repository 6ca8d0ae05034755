// The port that HAProxy's agent-check asks, over real sockets.
#include "tests/free_port.h"
#include "tests/net/session_fixture.h"

namespace brume::test {
namespace {

struct AgentTest : ServerTest {
    AgentTest() { options.agent_port = freePort(); }
    // All that the agent says before it closes.
    std::string answer() const {
        Socket socket(options.agent_port);
        std::string all = socket.readAll();
        EXPECT_TRUE(socket.closesWithin(0ms));
        return all;
    }
};

TEST_F(AgentTest, SaysHowMuchRoomThereIs) {
    max_viewers = 4;
    serve();
    EXPECT_EQ(answer(), "up ready 100%\n");
    const auto one = watch(), two = watch(), three = watch();
    EXPECT_EQ(answer(), "up ready 25%\n") << "of the places";
    audience->budget_used = 0.9f;
    EXPECT_EQ(answer(), "up ready 10%\n") << "of the frame budget";
    audience->budget_used = 0;
    audience->setTimeFor(3);
    EXPECT_EQ(answer(), "up ready 1%\n") << "the device has time for no more";
}

TEST_F(AgentTest, SaysWhatReadyzSays) {
    serve();
    audience->ready = false;
    EXPECT_EQ(answer(), "down\n");
    audience->ready = true;
    EXPECT_EQ(answer(), "up ready 100%\n") << "it comes back";
    server->drain();
    EXPECT_EQ(answer(), "drain\n");
    server->stop(1s);
    EXPECT_THROW(Socket late(options.agent_port), std::runtime_error) << "the port is closed";
}

TEST_F(AgentTest, WhoSaysNothingOrMuchDelaysNobody) {
    serve();
    const Socket silent(options.agent_port);
    Socket loud(options.agent_port);
    loud.send(std::string(100'000, 'x'));
    EXPECT_EQ(answer(), "up ready 100%\n");
    EXPECT_TRUE(loud.closesWithin(3s));
    EXPECT_EQ(get(server->port(), "/healthz").status, 200);
}

TEST_F(AgentTest, ATakenPortIsToldInOneLine) {
    serve();
    net::NetOptions other = options;
    std::string fault;
    try {
        NetServer(other, *audience, *metrics).start();
    } catch (const std::runtime_error& error) {
        fault = error.what();
    }
    EXPECT_EQ(fault, fmt::format("cannot listen on 127.0.0.1:{}: Address already in use; choose another with "
                                 "--agent-port",
                                 options.agent_port));
}

} // namespace
} // namespace brume::test
