// A gateway in front of the server: whose connection it is says the header of the PROXY protocol.
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/write.hpp>

#include "tests/net/certificate.h"
#include "tests/net/log_capture.h"
#include "tests/net/proxy_headers.h"
#include "tests/net/session_fixture.h"

namespace brume::test {
namespace {

namespace asio = boost::asio;

const std::string kHealth = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
const std::string kPage = "GET /nothing-here HTTP/1.1\r\nHost: localhost\r\n\r\n"; // 404 where there is room
constexpr char kTcp4Text[] = "PROXY TCP4 203.0.113.7 192.0.2.1 40000 8080\r\n";

size_t count(const std::string& text, const std::string& part) {
    size_t found = 0;
    for (size_t at = text.find(part); at != text.npos; at = text.find(part, at + 1)) ++found;
    return found;
}

struct ProxyTest : ServerTest {
    ProxyTest() { options.proxy_protocol = true; }

    // Sends this at once, and reads one answer.
    HttpAnswer ask(const std::string& bytes) const {
        Socket socket(server->port());
        socket.send(bytes);
        return readAnswer(socket);
    }
    std::unique_ptr<WsClient> join(const std::string& header) const {
        auto client = std::make_unique<WsClient>(server->port(), 0, "Sec-WebSocket-Protocol: brume.v1\r\n", header);
        EXPECT_EQ(client->handshake.status, 101);
        client->hello();
        return client;
    }
    double refused(const std::string& reason) const {
        const std::string text = metrics->text(*audience), series = "brume_refused_total{reason=\"" + reason + "\"} ";
        const size_t at = text.find(series);
        return at == text.npos ? 0 : std::stod(text.substr(at + series.size()));
    }
};

TEST_F(ProxyTest, TheLogHasTheAddressInTheHeader) {
    const LogCapture log;
    serve();
    int viewers = 0;
    for (const auto& [header, address] : {std::pair<std::string, std::string>{headerOf("203.0.113.7"), "203.0.113.7"},
                                          {headerOf("2001:db8::7", std::string("\x04\0\x01\0", 4)), "2001:db8::7"},
                                          {"PROXY TCP6 2001:db8::8 ::1 1 2\r\n", "2001:db8::8"},
                                          {binaryHeader(0, 0, ""), "127.0.0.1"},
                                          {binaryHeader(1, 0, "rest"), "127.0.0.1"}}) {
        ASSERT_TRUE(join(header)->next<wire::Welcome>()) << address;
        const std::string line = fmt::format("viewer {}: test client from {},", ++viewers, address);
        EXPECT_EQ(count(log.atLeast(spdlog::level::info), line), 1u) << log.atLeast(spdlog::level::info);
    }
    server.reset(); // before the log is put back
}

TEST_F(ProxyTest, EachAddressInAHeaderHasItsOwnLimit) {
    options.max_connections_per_address = 1;
    const uint16_t port = serve();
    const auto taken = [&](const std::string& header) {
        auto socket = std::make_unique<Socket>(port);
        socket->send(header + kHealth);
        EXPECT_EQ(readAnswer(*socket).status, 200);
        return socket;
    };
    const auto v4 = taken(headerOf("203.0.113.7")), v6 = taken(headerOf("2001:db8::7"));
    EXPECT_EQ(ask(headerOf("203.0.113.7") + kPage).status, 503);
    EXPECT_EQ(ask(headerOf("203.0.113.8") + kPage).status, 404) << "another viewer behind the same gateway";
    EXPECT_EQ(ask(headerOf("2001:db8::8") + kPage).status, 503) << "one site";
    EXPECT_EQ(ask(headerOf("2001:db8:0:1::7") + kPage).status, 404);
}

TEST_F(ProxyTest, EachAddressInAHeaderHasItsOwnRate) {
    options.accept_rate = 0.001;
    options.burst_s = 2000; // two
    serve();
    EXPECT_EQ(ask(headerOf("203.0.113.7") + kHealth).status, 200);
    EXPECT_EQ(ask(headerOf("203.0.113.7") + kHealth).status, 200);
    EXPECT_EQ(ask(headerOf("203.0.113.7") + kHealth).status, 429);
    EXPECT_EQ(ask(headerOf("203.0.113.8") + kHealth).status, 200);
}

TEST_F(ProxyTest, EachAddressInAHeaderHasItsOwnPlaces) {
    serve();
    audience->setMaxViewers(8, 1);
    const auto first = join(headerOf("203.0.113.7"));
    ASSERT_TRUE(first->next<wire::Welcome>());
    EXPECT_EQ(nextError(*join(headerOf("203.0.113.7"))), wire::ErrorCode::full);
    EXPECT_TRUE(join(headerOf("203.0.113.8"))->next<wire::Welcome>());
}

TEST_F(ProxyTest, ExactlyTheHeaderIsTaken) {
    const uint16_t port = serve();
    for (const std::string& header : {headerOf("203.0.113.7", std::string(1000, '\0')), std::string(kTcp4Text),
                                      std::string("PROXY UNKNOWN\r\n"), binaryHeader(0, 0, "")}) {
        EXPECT_EQ(ask(header + kHealth).status, 200) << "in one piece";
        Socket bytewise(port);
        for (const char byte : header + kHealth) bytewise.send(std::string(1, byte));
        EXPECT_EQ(readAnswer(bytewise).status, 200);
        bytewise.send(kHealth);
        EXPECT_EQ(readAnswer(bytewise).status, 200) << "one header is for all requests of its connection";
    }
}

TEST_F(ProxyTest, WithoutAHeaderAConnectionEndsInOneLine) {
    const LogCapture log;
    const uint16_t port = serve();
    double ended = 0;
    for (const auto& [bytes, line] :
         {std::pair<std::string, std::string>{
              kHealth, "127.0.0.1: no PROXY protocol header: connect through the gateway, or start without "
                       "--proxy-protocol\n"},
          {binaryHeader(1, 0x12, addressesOf("203.0.113.7")) + kHealth, "of a family that is not served"},
          {binaryHeader(1, 0x11, std::string(2100, 'x')), "of more than 2048 bytes"},
          {"PROXY TCP4 nobody nobody 1 2\r\n" + kHealth, "that is broken"}}) {
        const std::string& said = line; // Clang 14 lets no lambda have `line` itself
        Socket socket(port);
        socket.send(bytes);
        EXPECT_TRUE(socket.closesWithin(3s));
        ++ended;
        ASSERT_TRUE(eventually([&] { return refused("proxy_header") == ended; }));
        ASSERT_TRUE(eventually([&] { return count(log.atLeast(spdlog::level::warn), said) == 1; })) << said;
        EXPECT_EQ(count(log.atLeast(spdlog::level::warn), "\n"), size_t(ended)) << "no line besides";
    }
    { Socket look(port); } // a check of the port is nothing to tell of
    EXPECT_EQ(ask(headerOf("203.0.113.7") + kHealth).status, 200);
    EXPECT_EQ(refused("proxy_header"), ended);
    server.reset();
}

// Silent ones, and ones that stop in the middle: each is gone in time, and nobody waits for them.
TEST_F(ProxyTest, WhoOwesItsHeaderDelaysNobodyAndTakesNoPlace) {
    options.handshake = 700ms;
    options.max_connections = 50;
    options.max_connections_per_address = 2;
    const uint16_t port = serve();
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::unique_ptr<Socket>> owing;
    for (size_t i = 0; i < 50; ++i) {
        owing.push_back(std::make_unique<Socket>(port));
        owing.back()->send(i % 2 == 0 ? "" : headerOf("203.0.113.7").substr(0, i % 28));
    }
    EXPECT_EQ(ask(headerOf("203.0.113.8") + kPage).status, 404);
    EXPECT_LT(std::chrono::steady_clock::now() - start, options.handshake) << "while all of those were still there";
    for (const auto& one : owing) EXPECT_TRUE(one->closesWithin(3s));
    EXPECT_TRUE(eventually([&] { return refused("proxy_header") == 50; })) << refused("proxy_header");
}

TEST_F(ProxyTest, NoMoreOweTheirHeaderThanMayBeOpen) {
    options.max_connections = 1;
    const uint16_t port = serve();
    std::vector<std::unique_ptr<Socket>> owing;
    for (int i = 0; i < 17; ++i) owing.push_back(std::make_unique<Socket>(port)); // 16 are the reserve
    Socket over(port);
    EXPECT_NE(over.readAll(2s).find("503 "), std::string::npos) << "before its header";
    EXPECT_EQ(refused("connections"), 1);
    owing.front()->send(headerOf("203.0.113.7") + kHealth);
    EXPECT_EQ(readAnswer(*owing.front()).status, 200) << "who was in may still say who it is";
    EXPECT_EQ(ask(headerOf("203.0.113.8") + kHealth).status, 200) << "in its place";
}

TEST_F(ProxyTest, AStopEndsThoseThatOweTheirHeader) {
    options.handshake = 60s;
    const uint16_t port = serve();
    Socket silent(port), half(port);
    half.send("PROXY TCP4 ");
    EXPECT_EQ(ask(headerOf("203.0.113.7") + kHealth).status, 200); // the others are accepted by then
    const auto start = std::chrono::steady_clock::now();
    server->stop(30s);
    EXPECT_LT(std::chrono::steady_clock::now() - start, 15s) << "nobody waits for them";
    EXPECT_TRUE(silent.closesWithin(3s));
    EXPECT_TRUE(half.closesWithin(3s));
    EXPECT_EQ(refused("proxy_header"), 0) << "that is none of their faults";
}

TEST_F(ProxyTest, TlsFollowsTheHeader) {
    const LogCapture log;
    const Certificate certificate;
    options.tls_certificate = certificate.certificate();
    options.tls_key = certificate.key();
    const uint16_t port = serve();
    spdlog::default_logger()->set_level(spdlog::level::debug); // of the captured log
    asio::io_context io;
    asio::ssl::context context(asio::ssl::context::tls_client);
    context.load_verify_file(certificate.certificate());
    context.set_verify_mode(asio::ssl::verify_peer);
    asio::ssl::stream<asio::ip::tcp::socket> stream(io, context);
    stream.lowest_layer().connect({asio::ip::address_v4::loopback(), port});
    asio::write(stream.next_layer(), asio::buffer(headerOf("203.0.113.7")));
    stream.handshake(asio::ssl::stream_base::client);
    asio::write(stream, asio::buffer("GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"));
    std::string text;
    boost::system::error_code error;
    asio::read(stream, asio::dynamic_buffer(text), error);
    EXPECT_TRUE(text.ends_with("\r\n\r\nok\n")) << text;

    Socket plain(port); // a fault of TLS is told of the viewer, not of the gateway
    plain.send(headerOf("203.0.113.9") + kHealth);
    EXPECT_TRUE(plain.closesWithin(3s));
    EXPECT_TRUE(eventually([&] { return count(log.atLeast(spdlog::level::debug), "203.0.113.9: no TLS: ") == 1; }));
    server.reset();
}

TEST_F(ProxyTest, AReloadDoesNotChangeWhetherThereIsOne) {
    serve();
    net::NetOptions changed = options;
    changed.proxy_protocol = false;
    server->setOptions(changed);
    EXPECT_EQ(ask(headerOf("203.0.113.7") + kHealth).status, 200);
}

// Otherwise everyone could choose an address.
TEST_F(ProxyTest, WithoutTheOptionAHeaderIsNoRequest) {
    options.proxy_protocol = false;
    serve();
    EXPECT_EQ(ask(headerOf("203.0.113.7") + kHealth).status, 400);
    EXPECT_EQ(ask(kTcp4Text + kHealth).status, 400);
    EXPECT_EQ(ask(kHealth).status, 200);
}

} // namespace
} // namespace brume::test
