// Who may come in and do what, over real sockets: tokens, roles, and their end.
#include "server/net/token.h"
#include "tests/net/session_fixture.h"

namespace brume::test {
namespace {

using net::Role;
using wire::ErrorCode;

struct TrustTest : ServerTest {
    TrustTest() { options.token_key = std::string(net::kLeastKeyBytes, 'k'); }

    std::string token(Role role, std::chrono::seconds left = 60s) const {
        const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
        return net::makeToken({role, now + left, "ann"}, options.token_key);
    }
    static std::string bearer(const std::string& token) { return "Authorization: Bearer " + token + "\r\n"; }
    // Welcomed.
    std::unique_ptr<WsClient> enter(const std::string& token) {
        auto client =
            std::make_unique<WsClient>(server->port(), 0, "Sec-WebSocket-Protocol: brume.v1\r\n" + bearer(token));
        EXPECT_EQ(client->handshake.status, 101) << client->handshake.body;
        client->hello();
        const auto welcome = client->next<wire::Welcome>();
        EXPECT_TRUE(welcome);
        if (welcome) told = welcome->parsed->as<wire::Welcome>()->role();
        return client;
    }
    double refused(const std::string& reason) const {
        const std::string text = metrics->text(*audience), series = "brume_refused_total{reason=\"" + reason + "\"} ";
        const size_t at = text.find(series);
        return at == text.npos ? 0 : std::stod(text.substr(at + series.size()));
    }
    static bool oneLine(const std::string& body) { return body.size() > 1 && body.find('\n') == body.size() - 1; }

    Role told = Role::viewer; // by the last welcome
};

TEST_F(TrustTest, WithoutAGoodTokenNothingThatShowsTheSceneIsServed) {
    const uint16_t port = serve();
    std::string forged = token(Role::operator_);
    forged.back() = forged.back() == 'A' ? 'B' : 'A';
    const std::string expired = token(Role::operator_, -net::kClockSkew - 1s);
    for (const char* path : {"/snapshot.jpg", "/stream.mjpg", "/metrics", "/ws"})
        for (const std::string& bad : {std::string(), std::string("rubbish"), forged, expired}) {
            const HttpAnswer answer = get(port, path, bad.empty() ? "" : bearer(bad));
            EXPECT_EQ(answer.status, 401) << path << " with '" << bad << "'";
            EXPECT_TRUE(oneLine(answer.body)) << answer.body;
            EXPECT_EQ(answer.header("WWW-Authenticate"), "Bearer realm=\"brume\"");
            EXPECT_EQ(get(port, std::string(path) + "?token=" + bad).status, 401);
        }
    EXPECT_NE(get(port, "/ws", bearer(expired)).body.find("expired"), std::string::npos);
    EXPECT_EQ(WsClient(port).handshake.status, 401);
    EXPECT_GE(refused("token"), 33);
    // What a health check and the page itself need.
    EXPECT_EQ(get(port, "/healthz").status, 200);
    EXPECT_EQ(get(port, "/readyz").status, 200);
    EXPECT_EQ(audience->size(), 0u);
}

TEST_F(TrustTest, ATokenComesInTheHeaderOrTheQuery) {
    const uint16_t port = serve();
    const std::string viewer = token(Role::viewer);
    EXPECT_EQ(get(port, "/snapshot.jpg?w=64&h=64", bearer(viewer)).status, 200);
    EXPECT_EQ(get(port, "/snapshot.jpg?w=64&h=64&token=" + viewer).status, 200);
    EXPECT_EQ(get(port, "/ws?token=" + viewer).status, 426) << "let in, but no WebSocket";
    EXPECT_EQ(get(port, "/ws?token=" + viewer, "Origin: https://elsewhere.example\r\n").status, 403);
}

TEST_F(TrustTest, WhoMayControlMayPause) {
    const uint16_t port = serve();
    EXPECT_EQ(get(port, "/pause", "", "POST").status, 401);
    EXPECT_EQ(get(port, "/pause", bearer(token(Role::viewer)), "POST").status, 403);
    EXPECT_EQ(get(port, "/pause", bearer(token(Role::controller)), "POST").status, 200);
    EXPECT_EQ(get(port, "/resume", bearer(token(Role::operator_)), "POST").status, 200);
}

TEST_F(TrustTest, MetricsAreTheOperators) {
    const uint16_t port = serve();
    const HttpAnswer answer = get(port, "/metrics", bearer(token(Role::controller)));
    EXPECT_EQ(answer.status, 403);
    EXPECT_EQ(answer.body, "role controller may not do that: it takes operator\n");
    EXPECT_EQ(refused("forbidden"), 1);
    EXPECT_EQ(get(port, "/metrics", bearer(token(Role::operator_))).status, 200);
}

TEST_F(TrustTest, EachRoleDoesWhatItMayAndIsToldSo) {
    serve();
    static const wire::Vec3 ahead(0, 0, -1);
    const auto push = [](WsClient& client, uint32_t seq) {
        client.say([&](auto& b) {
            return wire::CreateInput(b, seq, 1, wire::Command::Impulse, wire::CreateImpulse(b, &ahead, &ahead).Union());
        });
    };
    const auto restart = [](WsClient& client, uint32_t seq) {
        client.say([&](auto& b) {
            return wire::CreateInput(b, seq, 1, wire::Command::Restart, wire::CreateRestart(b).Union());
        });
    };
    const auto taken = [&](size_t count) { return eventually([&] { return renderer->commands().size() == count; }); };

    const auto viewer = enter(token(Role::viewer));
    EXPECT_EQ(told, Role::viewer);
    viewer->pose(1);
    EXPECT_TRUE(frameOf(*viewer, 1)) << "it looks";
    push(*viewer, 1);
    EXPECT_EQ(nextError(*viewer), ErrorCode::forbidden);
    restart(*viewer, 2);
    EXPECT_EQ(nextError(*viewer), ErrorCode::forbidden);

    const auto controller = enter(token(Role::controller));
    EXPECT_EQ(told, Role::controller);
    push(*controller, 1);
    EXPECT_TRUE(taken(1));
    restart(*controller, 2);
    EXPECT_EQ(nextError(*controller), ErrorCode::forbidden);

    const auto chief = enter(token(Role::operator_));
    EXPECT_EQ(told, Role::operator_);
    push(*chief, 1);
    restart(*chief, 2);
    EXPECT_TRUE(taken(3));
    viewer->pose(2);
    EXPECT_TRUE(frameOf(*viewer, 2)) << "and still looks";
    EXPECT_EQ(refused("forbidden"), 3);
}

TEST_F(TrustTest, ASessionAndAStreamEndWithTheirToken) {
    serve();
    const std::string brief = token(Role::viewer, 2s - net::kClockSkew);
    Socket stream(server->port());
    stream.send("GET /stream.mjpg?w=64&h=64 HTTP/1.1\r\nHost: localhost\r\n" + bearer(brief) + "\r\n");
    ASSERT_NE(stream.readUntil("\r\n").find(" 200 "), std::string::npos);
    const auto client = enter(brief), lasting = enter(token(Role::viewer));
    client->pose(1);
    EXPECT_TRUE(frameOf(*client, 1));
    const auto goodbye = client->next<wire::Goodbye>();
    ASSERT_TRUE(goodbye);
    EXPECT_EQ(goodbye->parsed->as<wire::Goodbye>()->reason()->str(), "the token has expired");
    EXPECT_EQ(client->closeCode(), 1008);
    EXPECT_TRUE(stream.closesWithin(2s));
    EXPECT_TRUE(eventually([&] { return audience->size() == 1; }));
    lasting->pose(1);
    EXPECT_TRUE(frameOf(*lasting, 1));
}

TEST_F(TrustTest, WhoeverResumesHasTheRoleOfTheNewToken) {
    serve();
    const auto chief = enter(token(Role::operator_));
    chief->socket.reset();
    ASSERT_TRUE(eventually([&] { return audience->size() == 0; }));
    enter(token(Role::viewer));
    EXPECT_EQ(told, Role::viewer);
}

TEST_F(TrustTest, AnotherKeyEndsTheOldTokensAndNotTheOpenSessions) {
    serve();
    const std::string old = token(Role::viewer);
    const auto inside = enter(old);
    options.token_key = std::string(net::kLeastKeyBytes, 'n');
    server->setOptions(options);
    EXPECT_EQ(get(server->port(), "/snapshot.jpg", bearer(old)).status, 401);
    enter(token(Role::viewer));
    inside->pose(1);
    EXPECT_TRUE(frameOf(*inside, 1));
}

// Strangers hold every place: an operator's request still gets through, one that never ends does not.
TEST_F(TrustTest, AGoodTokenGetsThroughWhenAllConnectionsAreTaken) {
    options.max_connections = 2;
    const uint16_t port = serve();
    const Socket one(port), two(port);
    const std::string chief = bearer(token(Role::operator_));
    EXPECT_EQ(get(port, "/viewers", chief).status, 200);
    EXPECT_EQ(get(port, "/viewers", chief).header("Connection"), "close");
    EXPECT_EQ(get(port, "/snapshot.jpg?w=64&h=36", bearer(token(Role::viewer))).status, 200);
    EXPECT_EQ(get(port, "/stream.mjpg", chief).status, 503);
    EXPECT_EQ(get(port, "/ws", chief).status, 503);
    EXPECT_EQ(get(port, "/viewers").status, 401);
    EXPECT_EQ(get(port, "/").status, 503);
}

TEST_F(TrustTest, AnAddressThatComesTooOftenIsTurnedAway) {
    options.accept_rate = 5; // a burst of 10
    const uint16_t port = serve();
    int served = 0, turned_away = 0;
    for (int i = 0; i < 30; ++i) {
        const int status = get(port, "/healthz").status;
        served += status == 200;
        turned_away += status == 429;
    }
    EXPECT_GE(served, 10);
    EXPECT_GE(turned_away, 10);
    EXPECT_EQ(served + turned_away, 30);
    EXPECT_GE(refused("accept_rate"), 10);
    EXPECT_TRUE(eventually([&] { return get(port, "/healthz").status == 200; })) << "only for a while";
}

} // namespace
} // namespace brume::test
