// Trusted proxies in front of the server: whose a request is says X-Forwarded-For.
#include "tests/net/log_capture.h"
#include "tests/net/session_fixture.h"

namespace brume::test::forwarded_test {
namespace {

constexpr char kHealth[] = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n";
constexpr char kProtocol[] = "Sec-WebSocket-Protocol: brume.v1\r\n";

std::string of(const std::string& forwarded) { return "X-Forwarded-For: " + forwarded + "\r\n"; }

struct ForwardedTest : ServerTest {
    ForwardedTest() { options.trusted_proxies = {*net::Network::read("127.0.0.1"), *net::Network::read("10.0.0.0/8")}; }

    static int ask(Socket& proxy, const std::string& forwarded) {
        proxy.send(kHealth + forwarded + "\r\n");
        return readAnswer(proxy).status;
    }
    std::unique_ptr<WsClient> join(const std::string& forwarded) const {
        auto client = std::make_unique<WsClient>(server->port(), 0, kProtocol + forwarded);
        client->hello();
        return client;
    }
};

TEST_F(ForwardedTest, TheLogHasTheVisitorsAddress) {
    const LogCapture log;
    serve();
    int viewers = 0;
    for (const auto& [forwarded, address] : {std::pair<std::string, std::string>{of("203.0.113.7"), "203.0.113.7"},
                                             {of("192.0.2.1, 203.0.113.8"), "203.0.113.8"},
                                             {of("192.0.2.1") + of("2001:db8::7, 10.0.0.9"), "2001:db8::7"},
                                             {of("10.1.1.1, 203.0.113.9"), "203.0.113.9"},
                                             {"Forwarded: for=203.0.113.7\r\n", "127.0.0.1"},
                                             {"", "127.0.0.1"}}) {
        ASSERT_TRUE(join(forwarded)->next<wire::Welcome>()) << forwarded;
        const std::string line = fmt::format("viewer {}: test client from {},", ++viewers, address);
        EXPECT_NE(log.atLeast(spdlog::level::info).find(line), std::string::npos) << line;
    }
    server.reset(); // before the log is put back
}

TEST_F(ForwardedTest, WithoutTheOptionAndFromOthersTheHeaderIsNotRead) {
    for (const bool others : {false, true}) {
        options.trusted_proxies.clear();
        if (others) options.trusted_proxies = {*net::Network::read("10.0.0.0/8"), *net::Network::read("::1")};
        const LogCapture log;
        serve();
        ASSERT_TRUE(join(of("203.0.113.7"))->next<wire::Welcome>());
        EXPECT_NE(log.atLeast(spdlog::level::info).find("test client from 127.0.0.1,"), std::string::npos);
        server.reset();
        renderer.reset();
    }
}

TEST_F(ForwardedTest, ASocketCountsForItsVisitorAndAProxyForNobody) {
    options.max_connections_per_address = 2;
    const uint16_t port = serve();
    std::vector<std::unique_ptr<WsClient>> open;
    for (const char* visitor :
         {"203.0.113.1", "203.0.113.1", "203.0.113.2", "203.0.113.3", "2001:db8::1", "2001:db8::2"}) {
        open.push_back(std::make_unique<WsClient>(port, 0, kProtocol + of(visitor)));
        EXPECT_EQ(open.back()->handshake.status, 101) << visitor;
    }
    EXPECT_EQ(WsClient(port, 0, kProtocol + of("203.0.113.1")).handshake.status, 503);
    EXPECT_EQ(WsClient(port, 0, kProtocol + of("192.0.2.77, 203.0.113.1")).handshake.status, 503) << "forged";
    EXPECT_EQ(WsClient(port, 0, kProtocol + of("2001:db8::3")).handshake.status, 503) << "one site";
    EXPECT_EQ(WsClient(port, 0, kProtocol + of("2001:db8:0:1::3")).handshake.status, 101);
    open.erase(open.begin());
    EXPECT_TRUE(eventually([&] { return WsClient(port, 0, kProtocol + of("203.0.113.1")).handshake.status == 101; }))
        << "its place is free again";
}

TEST_F(ForwardedTest, AConnectionOfAProxyCarriesRequestsOfMany) {
    options.max_connections_per_address = 1;
    const uint16_t port = serve();
    Socket one(port), two(port), three(port); // kept by the proxy
    for (Socket* proxy : {&one, &two, &three, &one, &two, &three})
        EXPECT_EQ(ask(*proxy, of("203.0.113.1")), 200) << "a request that has ended takes no place";
    const WsClient socket(port, 0, kProtocol + of("203.0.113.1"));
    EXPECT_EQ(socket.handshake.status, 101);
    EXPECT_EQ(ask(one, of("203.0.113.1")), 503) << "that visitor has its one place";
    EXPECT_EQ(ask(one, of("203.0.113.2")), 200) << "and the next request on the same connection is another's";
    EXPECT_EQ(ask(one, of("203.0.113.1")), 503);
    EXPECT_EQ(ask(one, ""), 200) << "the proxy's own";
}

TEST_F(ForwardedTest, EachVisitorHasItsOwnRate) {
    options.accept_rate = 0.001;
    options.burst_s = 2000; // two
    const uint16_t port = serve();
    Socket proxy(port);
    EXPECT_EQ(ask(proxy, of("203.0.113.1")), 200);
    EXPECT_EQ(ask(proxy, of("203.0.113.1")), 200);
    EXPECT_EQ(ask(proxy, of("203.0.113.1")), 429);
    EXPECT_EQ(ask(proxy, of("192.0.2.5, 203.0.113.1")), 429) << "forged";
    EXPECT_EQ(ask(proxy, of("203.0.113.2")), 200);
    for (int i = 0; i < 8; ++i)
        EXPECT_EQ(ask(*std::make_unique<Socket>(port), of(fmt::format("203.0.113.1{}", i))), 200);
}

TEST_F(ForwardedTest, EachVisitorHasItsOwnPlaces) {
    serve();
    audience->setMaxViewers(8, 1);
    const auto first = join(of("203.0.113.1"));
    ASSERT_TRUE(first->next<wire::Welcome>());
    EXPECT_EQ(nextError(*join(of("203.0.113.1"))), wire::ErrorCode::full);
    EXPECT_TRUE(join(of("203.0.113.2"))->next<wire::Welcome>());
}

TEST_F(ForwardedTest, ConnectionsOfAProxyHaveTheLimitOfAll) {
    options.max_connections = 2;
    const uint16_t port = serve();
    std::vector<std::unique_ptr<Socket>> kept;
    for (int i = 0; i < 18; ++i) { // 16 are the reserve
        kept.push_back(std::make_unique<Socket>(port));
        EXPECT_EQ(ask(*kept.back(), of(fmt::format("203.0.113.{}", i))), 200);
    }
    EXPECT_NE(Socket(port).readAll(2s).find("503 "), std::string::npos);
}

} // namespace
} // namespace brume::test::forwarded_test
