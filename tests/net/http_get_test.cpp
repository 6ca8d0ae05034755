// What programs fetch by HTTP, and what they are told where there is nothing to be had.
#include "client/native/http_get.h"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>

#include "server/net/token.h"
#include "tests/net/certificate.h"
#include "tests/net/fixture.h"

namespace brume::test {
namespace {

using client::Endpoint;

struct HttpGetTest : ServerTest {
    static Endpoint at(uint16_t port) { return {.host = "127.0.0.1", .port = port}; }

    static std::string problem(const Endpoint& endpoint, const std::string& path = "/particles.ply",
                               uint64_t most = 1 << 20) {
        try {
            client::httpGet(endpoint, path, 500ms, most);
        } catch (const std::runtime_error& error) {
            EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
            return error.what();
        }
        return "";
    }
    std::string token(net::Role role) const {
        const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
        return net::makeToken({role, now + 60s, "ann"}, options.token_key);
    }
};

TEST_F(HttpGetTest, TheBodyComesWhole) {
    const Endpoint where = at(serve());
    const std::string ply = client::httpGet(where, "/particles.ply", 5s, 1 << 20);
    EXPECT_EQ(ply.find("ply\nformat binary_little_endian 1.0\n"), 0u);
    const std::string healthy = get(where.port, "/healthz").body;
    EXPECT_EQ(client::httpGet(where, "/healthz", 5s, healthy.size()), healthy);
    EXPECT_EQ(problem(where, "/healthz", healthy.size() - 1), "its answer is too long");
    EXPECT_EQ(problem(where, "/nothing").find("it answers HTTP 404 Not Found: no such page"), 0u);
}

TEST_F(HttpGetTest, TokensAreShown) {
    options.token_key = std::string(net::kLeastKeyBytes, 'k');
    Endpoint where = at(serve());
    EXPECT_EQ(problem(where).find("it answers HTTP 401 Unauthorized: "), 0u) << problem(where);
    where.token = token(net::Role::viewer);
    const std::string viewer = problem(where);
    EXPECT_EQ(viewer.find("it answers HTTP 403 Forbidden: "), 0u) << viewer;
    EXPECT_TRUE(viewer.ends_with("(--token-file)")) << viewer;
    where.token = token(net::Role::operator_);
    EXPECT_EQ(problem(where), "");
}

TEST_F(HttpGetTest, TlsIsVerified) {
    const Certificate certificate;
    options.tls_certificate = certificate.certificate();
    options.tls_key = certificate.key();
    Endpoint where = at(serve());
    where.tls = true;
    EXPECT_EQ(problem(where).find("its certificate is not trusted: "), 0u) << problem(where);
    where.ca = certificate.certificate();
    EXPECT_EQ(problem(where), "");
}

TEST_F(HttpGetTest, NoServerAndASilentOneAreSaid) {
    namespace asio = boost::asio;
    asio::io_context io;
    asio::ip::tcp::acceptor silent(io, {asio::ip::address_v4::loopback(), 0});
    Endpoint where = at(silent.local_endpoint().port());
    EXPECT_EQ(problem(where), "no answer in time");
    silent.close();
    EXPECT_EQ(problem(where), "Connection refused (is the server running there?)");
    where.tls = true, where.ca = "/no/such/file";
    EXPECT_EQ(problem(where).find("--ca '/no/such/file' cannot be read"), 0u);
}

} // namespace
} // namespace brume::test
