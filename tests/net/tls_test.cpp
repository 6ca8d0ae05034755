// TLS: what it carries, who is turned away, and that nobody waits for those who do not get through it.
#include <fstream>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/write.hpp>

#include "tests/net/certificate.h"
#include "tests/net/session_fixture.h"

namespace brume::test {
namespace {

namespace asio = boost::asio;
namespace ssl = asio::ssl;

struct TlsTest : ServerTest {
    Certificate certificate;

    TlsTest() {
        options.tls_certificate = certificate.certificate();
        options.tls_key = certificate.key();
    }

    struct Answer {
        std::string text, version, fault;
        long serial = 0;
    };
    // The whole answer to a request over a connection of its own, the server's certificate verified.
    Answer ask(const std::string& path, int newest = 0, const char* suites = nullptr) const {
        asio::io_context io;
        ssl::context context(ssl::context::tls_client);
        context.load_verify_file(certificate.certificate());
        context.set_verify_mode(ssl::verify_peer);
        context.set_verify_callback(ssl::host_name_verification("127.0.0.1"));
        if (newest != 0) SSL_CTX_set_max_proto_version(context.native_handle(), newest);
        if (suites) SSL_CTX_set_cipher_list(context.native_handle(), suites);
        ssl::stream<asio::ip::tcp::socket> stream(io, context);
        Answer answer;
        boost::system::error_code error;
        stream.lowest_layer().connect({asio::ip::address_v4::loopback(), server->port()}, error);
        if (!error) stream.handshake(ssl::stream_base::client, error);
        if (error) {
            answer.fault = error.message();
            return answer;
        }
        answer.version = SSL_get_version(stream.native_handle());
        X509* const peer = SSL_get1_peer_certificate(stream.native_handle());
        answer.serial = ASN1_INTEGER_get(X509_get0_serialNumber(peer));
        X509_free(peer);
        asio::write(stream, asio::buffer("GET " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n"),
                    error);
        asio::read(stream, asio::dynamic_buffer(answer.text), error);
        EXPECT_EQ(error, asio::error::eof) << "closed as TLS is, not cut: " << error.message();
        return answer;
    }
    double failures() const {
        const std::string text = metrics->text(*audience), series = "brume_refused_total{reason=\"tls\"} ";
        const size_t at = text.find(series);
        return at == text.npos ? 0 : std::stod(text.substr(at + series.size()));
    }
};

TEST_F(TlsTest, CarriesWhatTheServerServes) {
    serve();
    renderer->jpeg_bytes = 300'000; // many records
    const Answer page = ask("/healthz"), picture = ask("/snapshot.jpg");
    EXPECT_EQ(page.version, "TLSv1.3") << page.fault;
    EXPECT_TRUE(page.text.ends_with("\r\n\r\nok\n")) << page.text;
    EXPECT_NE(picture.text.find("Content-Length: 300000\r\n"), std::string::npos);
    EXPECT_EQ(picture.text.size() - picture.text.find("\r\n\r\n") - 4, 300'000u);
    EXPECT_EQ(ask("/healthz", TLS1_2_VERSION).version, "TLSv1.2");
    EXPECT_EQ(failures(), 0);
}

TEST_F(TlsTest, OlderVersionsAreRefusedAndCounted) {
    serve();
    EXPECT_NE(ask("/healthz", TLS1_1_VERSION).fault, "");
    EXPECT_TRUE(eventually([&] { return failures() == 1; }));
    EXPECT_TRUE(ask("/healthz").text.ends_with("ok\n"));
}

// Whatever the key: with one of RSA a client could ask for suites without forward secrecy.
TEST_F(TlsTest, EverySuiteHasForwardSecrecy) {
    certificate.renew(Certificate::Kind::rsa);
    serve();
    for (const char* suite : {"AES128-GCM-SHA256", "AES256-SHA256", "AES256-SHA", "ECDHE-RSA-AES256-SHA"})
        EXPECT_NE(ask("/healthz", TLS1_2_VERSION, suite).fault, "") << suite;
    for (const char* suite : {"ECDHE-RSA-AES128-GCM-SHA256", "ECDHE-RSA-CHACHA20-POLY1305"})
        EXPECT_EQ(ask("/healthz", TLS1_2_VERSION, suite).version, "TLSv1.2") << suite;
    EXPECT_EQ(ask("/healthz").version, "TLSv1.3");
}

// One that speaks HTTP, one noise, ones that say nothing or half of a hello: each is gone in time, and nobody waits for
// them.
TEST_F(TlsTest, WhoDoesNotGetThroughDelaysNobody) {
    options.handshake = 700ms;
    const uint16_t port = serve();
    Socket plain(port), noise(port), half(port);
    std::vector<std::unique_ptr<Socket>> silent;
    for (int i = 0; i < 50; ++i) silent.push_back(std::make_unique<Socket>(port));
    plain.send("GET / HTTP/1.1\r\nHost: localhost\r\n\r\n");
    noise.send(std::string(2000, '\x5a'));
    half.send(std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11));
    const auto start = std::chrono::steady_clock::now();
    EXPECT_TRUE(ask("/healthz").text.ends_with("ok\n"));
    EXPECT_LT(std::chrono::steady_clock::now() - start, options.handshake) << "while all of those were still there";
    EXPECT_TRUE(plain.closesWithin(3s));
    EXPECT_TRUE(noise.closesWithin(3s));
    EXPECT_TRUE(half.closesWithin(3s));
    for (const auto& one : silent) EXPECT_TRUE(one->closesWithin(3s));
    EXPECT_TRUE(eventually([&] { return failures() == 53; })) << failures();
}

TEST_F(TlsTest, ARenewedCertificateIsTakenAndABadOneIsNot) {
    serve();
    EXPECT_EQ(ask("/healthz").serial, 1);
    certificate.renew();
    server->setOptions(options);
    EXPECT_EQ(ask("/healthz").serial, 2);
    std::ofstream(certificate.key()) << "no key";
    EXPECT_THROW(server->setOptions(options), std::runtime_error);
    EXPECT_EQ(ask("/healthz").serial, 2) << "what was good holds";
}

TEST_F(TlsTest, ABadCertificateEndsTheStartInOneLine) {
    const auto fault = [&](const std::string& chain, const std::string& key) -> std::string {
        TearDown();
        options.tls_certificate = chain;
        options.tls_key = key;
        try {
            serve();
        } catch (const std::runtime_error& error) {
            return error.what();
        }
        return "";
    };
    const Certificate other;
    EXPECT_NE(fault("/nowhere.pem", certificate.key()).find("--tls-certificate /nowhere.pem: "), std::string::npos);
    EXPECT_NE(fault(certificate.certificate(), "/nowhere.pem").find("--tls-key /nowhere.pem: "), std::string::npos);
    const std::string mismatch = fault(certificate.certificate(), other.key());
    EXPECT_NE(mismatch.find("--tls-key"), std::string::npos);
    EXPECT_EQ(mismatch.find('\n'), std::string::npos);
    std::filesystem::permissions(certificate.key(), std::filesystem::perms(0604));
    EXPECT_NE(fault(certificate.certificate(), certificate.key()).find("others may read or change it"),
              std::string::npos);
}

} // namespace
} // namespace brume::test
