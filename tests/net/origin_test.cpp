// Requests that another site's page may have made a visitor's browser send.
#include <filesystem>
#include <fstream>

#include "server/net/routes.h"
#include "server/net/token.h"
#include "tests/net/fixture.h"
#include "tests/net/log_capture.h"

namespace brume::test {
namespace {

constexpr const char* kRoutes[] = {"/",        "/ws",      "/healthz",     "/readyz", "/snapshot.jpg", "/stream.mjpg",
                                   "/metrics", "/viewers", "/no-such-page"};
// That cost device time or reveal something.
constexpr const char* kGuarded[] = {"/ws", "/snapshot.jpg", "/stream.mjpg", "/metrics", "/viewers"};
constexpr const char* kUpgrade =
    "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Protocol: brume.v1\r\n";

struct OriginTest : ServerTest {
    OriginTest() {
        std::string name = (std::filesystem::temp_directory_path() / "brume-origin-test-XXXXXX").string();
        options.web_root = mkdtemp(name.data());
        std::ofstream(options.web_root / "index.html") << "<!doctype html>";
    }
    ~OriginTest() override { std::filesystem::remove_all(options.web_root); }

    // `headers` are all there are.
    HttpAnswer ask(const std::string& route, const std::string& headers, const std::string& version = "1.1") const {
        Socket socket(server->port());
        socket.send(fmt::format("GET {} HTTP/{}\r\n{}\r\n", route, version, headers));
        return readAnswer(socket);
    }
    HttpAnswer askFrom(const std::string& route, const std::string& site, const std::string& more = "") const {
        return ask(route, fmt::format("Host: localhost\r\nSec-Fetch-Site: {}\r\n{}", site, more));
    }
    double refused(const std::string& reason) const {
        const std::string text = metrics->text(*audience), series = "brume_refused_total{reason=\"" + reason + "\"} ";
        const size_t at = text.find(series);
        return at == text.npos ? 0 : std::stod(text.substr(at + series.size()));
    }
    static bool oneLineWith(const std::string& body, const std::string& option) {
        return body.find(option) != body.npos && body.find('\n') == body.size() - 1;
    }
};

// The page of evil.example has come from its own server; then that name leads to this machine (DNS rebinding).
TEST_F(OriginTest, AReboundNameReachesNothing) {
    const uint16_t port = serve();
    const std::string host = fmt::format("evil.example:{}", port),
                      headers = fmt::format("Host: {0}\r\nOrigin: http://{0}\r\n", host);
    for (const char* route : kRoutes) {
        const HttpAnswer answer = ask(route, headers);
        EXPECT_EQ(answer.status, 421) << route;
        EXPECT_TRUE(oneLineWith(answer.body, "--host")) << route << ": " << answer.body;
    }
    EXPECT_EQ(ask("/ws", headers + kUpgrade).status, 421);
    EXPECT_EQ(refused("host"), double(std::size(kRoutes) + 1));
    EXPECT_EQ(audience->size(), 0u);
}

TEST_F(OriginTest, OwnNamesAndAddressesAreServed) {
    options.listen = "localhost";
    options.hosts = {"clouds.example"};
    const uint16_t port = serve();
    for (const char* name : {"localhost", "brume.localhost", "127.0.0.1", "[::1]", "192.0.2.7", "clouds.example"}) {
        const std::string host = fmt::format("{}:{}", name, port);
        for (const char* route : {"/", "/healthz", "/snapshot.jpg", "/metrics", "/viewers"})
            EXPECT_EQ(ask(route, "Host: " + host + "\r\n").status, 200) << host << route;
        EXPECT_EQ(ask("/ws", fmt::format("Host: {0}\r\nOrigin: http://{0}\r\n{1}", host, kUpgrade)).status, 101)
            << host;
    }
    options.hosts = {"other.example"};
    server->setOptions(options);
    EXPECT_EQ(ask("/healthz", "Host: clouds.example\r\n").status, 421);
    EXPECT_EQ(ask("/healthz", "Host: other.example\r\n").status, 200) << "a reload changes the names";
}

TEST_F(OriginTest, OneHostHeaderIsNeeded) {
    serve();
    EXPECT_EQ(ask("/healthz", "").status, 400);
    EXPECT_EQ(ask("/healthz", "Host: localhost\r\nHost: evil.example\r\n").status, 400);
    EXPECT_EQ(ask("/healthz", "Host:\r\n").status, 421);
    EXPECT_EQ(ask("/healthz", "", "1.0").status, 200) << "a simple health check, no browser";
    EXPECT_EQ(ask("/healthz", "Host: evil.example\r\n", "1.0").status, 421);
}

// A token is no page's to know, so that a rebound name has nothing but what everyone may see.
TEST_F(OriginTest, WithAKeyTokensDecide) {
    options.token_key = std::string(net::kLeastKeyBytes, 'k');
    serve();
    for (const char* route : kGuarded) EXPECT_EQ(ask(route, "Host: clouds.example\r\n").status, 401) << route;
    EXPECT_EQ(ask("/healthz", "Host: clouds.example\r\n").status, 200);
}

// <img src="http://localhost:8080/stream.mjpg"> in a page of evil.example.
TEST_F(OriginTest, APageOfAnotherSiteTakesNothing) {
    serve();
    for (const char* route : kGuarded) {
        const HttpAnswer answer =
            askFrom(route, "cross-site", "Sec-Fetch-Mode: no-cors\r\nReferer: https://evil.example/\r\n");
        EXPECT_EQ(answer.status, 403) << route;
        EXPECT_TRUE(oneLineWith(answer.body, "--allow-origin")) << route << ": " << answer.body;
    }
    EXPECT_EQ(askFrom("/ws", "cross-site", kUpgrade).status, 403);
    EXPECT_EQ(refused("origin"), double(std::size(kGuarded) + 1));
    EXPECT_EQ(audience->size(), 0u);
    EXPECT_EQ(askFrom("/", "cross-site", "Sec-Fetch-Mode: navigate\r\n").status, 200) << "a link to the page";
    EXPECT_EQ(askFrom("/healthz", "cross-site").status, 200) << "a page that asks whether this server is there";
    for (const char* site : {"same-origin", "none"}) EXPECT_EQ(askFrom("/snapshot.jpg", site).status, 200) << site;
    EXPECT_EQ(askFrom("/snapshot.jpg", "same-site").status, 403) << "another port of this host";
}

// Any page that somebody on the network opens can send a request here; what it is allowed to, depends on its origin.
TEST_F(OriginTest, EveryRouteByEveryOrigin) {
    options.allowed_origins = {"https://a.example"};
    options.max_connections_per_address = 256;
    options.accept_rate = 10000;
    const uint16_t port = serve();
    const std::string own = fmt::format("http://localhost:{}", port);
    struct Page {
        std::string origin; // empty: none is sent
        const char* site;
        bool may;
    };
    const Page pages[] = {{own, "same-origin", true},
                          {"https://a.example", "cross-site", true},
                          {"https://evil.example", "cross-site", false},
                          {"null", "cross-site", false},
                          {fmt::format("http://localhost:{}", port + 1), "same-site", false},
                          {"https://localhost", "same-site", false},
                          {"", "none", true}};
    for (const net::Route& route : net::allRoutes()) {
        const bool guarded = route.least.has_value();
        const std::string method = route.methods.starts_with("GET") ? "GET" : "POST";
        for (const Page& page : pages)
            for (const bool says : {false, true}) { // true: the browser sends Sec-Fetch-Site
                std::string head = fmt::format("{} {} HTTP/1.1\r\nHost: localhost:{}\r\nContent-Length: 0\r\n", method,
                                               route.path, port);
                if (!page.origin.empty()) head += fmt::format("Origin: {}\r\n", page.origin);
                if (says) head += fmt::format("Sec-Fetch-Site: {}\r\n", page.site);
                Socket socket(port);
                socket.send(head + "\r\n");
                const std::string answer = socket.readUntil("\r\n\r\n");
                EXPECT_EQ(answer.find(" 403 ") != answer.npos, guarded && !page.may)
                    << route.path << " for " << page.origin << ' ' << says << ": " << answer;
                const bool shared = answer.find("Access-Control-Allow-Origin: https://a.example\r\n") != answer.npos;
                EXPECT_EQ(shared, page.origin == "https://a.example") << route.path << ": " << answer;
            }
    }
    EXPECT_EQ(renderer->commands().size(), 2u * 2 * 3) << "pause and resume, by those who may";
}

TEST_F(OriginTest, AForeignPagesOriginIsTold) {
    const LogCapture log;
    serve();
    EXPECT_EQ(ask("/snapshot.jpg", "Host: localhost\r\nOrigin: https://evil.example\r\n").status, 403);
    server.reset();
    const std::string lines = log.atLeast(spdlog::level::warn);
    EXPECT_NE(lines.find("a page of https://evil.example was refused"), lines.npos) << lines;
    EXPECT_NE(lines.find("--allow-origin"), lines.npos) << lines;
}

TEST_F(OriginTest, ABrowserMayAskBeforeItAsks) {
    options.allowed_origins = {"https://a.example"};
    const uint16_t port = serve();
    const auto preflight = [&](const char* path, const char* origin) {
        return get(port, path,
                   fmt::format("Origin: {}\r\nAccess-Control-Request-Method: POST\r\n"
                               "Access-Control-Request-Headers: authorization\r\n",
                               origin),
                   "OPTIONS");
    };
    const HttpAnswer pause = preflight("/pause", "https://a.example");
    EXPECT_EQ(pause.status, 204);
    EXPECT_EQ(pause.header("Access-Control-Allow-Origin"), "https://a.example");
    EXPECT_EQ(pause.header("Access-Control-Allow-Methods"), "POST");
    EXPECT_EQ(pause.header("Access-Control-Allow-Headers"), "Authorization, Content-Type");
    EXPECT_EQ(pause.header("Content-Length"), "");
    EXPECT_EQ(preflight("/snapshot.jpg", "https://a.example").header("Access-Control-Allow-Methods"), "GET");
    EXPECT_EQ(preflight("/pause", "https://evil.example").status, 403);
    EXPECT_EQ(get(port, "/", "", "OPTIONS").header("Allow"), "GET, HEAD, OPTIONS");
    EXPECT_TRUE(renderer->commands().empty());
}

TEST_F(OriginTest, APageOfAnAllowedSiteIsServed) {
    options.allowed_origins = {"https://a.example"};
    serve();
    EXPECT_EQ(askFrom("/snapshot.jpg", "cross-site", "Referer: https://a.example/wall\r\n").status, 200);
    EXPECT_EQ(askFrom("/snapshot.jpg", "cross-site", "Origin: https://a.example\r\n").status, 200);
    EXPECT_EQ(askFrom("/ws", "cross-site", "Origin: https://a.example\r\n" + std::string(kUpgrade)).status, 101);
    EXPECT_EQ(askFrom("/snapshot.jpg", "cross-site", "Referer: https://b.example/wall\r\n").status, 403);
    EXPECT_EQ(askFrom("/snapshot.jpg", "cross-site").status, 403);
}

// What a browser asks before it gives a page what is another origin's: also where no Sec-Fetch-Site is sent.
TEST_F(OriginTest, EveryReplySaysWhoMayEmbedIt) {
    options.accept_rate = 20; // a burst of 40
    const uint16_t port = serve();
    const auto policies = [&](const std::string& policy) {
        constexpr const char* kHeader = "Cross-Origin-Resource-Policy";
        for (const char* route : {"/", "/ws", "/snapshot.jpg", "/metrics", "/no-such-page"})
            EXPECT_EQ(ask(route, "Host: localhost\r\n").header(kHeader), policy) << route;
        for (const char* route : {"/healthz", "/readyz"}) // a page asks another server if it is there
            EXPECT_EQ(ask(route, "Host: localhost\r\n").header(kHeader), "cross-origin") << route;
        EXPECT_EQ(ask("/", "Host: evil.example\r\n").header(kHeader), policy);
        EXPECT_EQ(ask("/ws", "Host: localhost\r\n" + std::string(kUpgrade)).header(kHeader), policy);
        Socket stream(port);
        stream.send("GET /stream.mjpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
        EXPECT_NE(stream.readUntil("\r\n\r\n").find(kHeader + (": " + policy)), std::string::npos);
    };
    policies("same-origin");
    options.allowed_origins = {"https://a.example"};
    server->setOptions(options);
    policies("cross-origin");
    HttpAnswer answer;
    for (int i = 0; i < 60 && answer.status != 429; ++i) answer = ask("/healthz", "Host: localhost\r\n");
    EXPECT_EQ(answer.status, 429);
    EXPECT_EQ(answer.header("Cross-Origin-Resource-Policy"), "cross-origin");
}

TEST_F(OriginTest, ThePageRunsItsOwnFilesOnlyAndInFramesOfItsOwn) {
    serve();
    const HttpAnswer page = ask("/", "Host: localhost\r\n");
    const std::string policy = page.header("Content-Security-Policy");
    EXPECT_TRUE(policy.starts_with("default-src 'self'; ")) << policy;
    EXPECT_TRUE(policy.ends_with("; frame-ancestors 'self'")) << policy;
    EXPECT_EQ(policy.find("unsafe"), policy.npos) << policy;
    EXPECT_EQ(page.header("Referrer-Policy"), "no-referrer");
    const std::string known = "Host: localhost\r\nIf-None-Match: " + page.header("ETag") + "\r\n";
    EXPECT_EQ(ask("/", known).header("Content-Security-Policy"), policy) << "also where nothing changed";
    options.allowed_origins = {"https://a.example", "https://b.example"};
    server->setOptions(options);
    EXPECT_TRUE(ask("/", "Host: localhost\r\n")
                    .header("Content-Security-Policy")
                    .ends_with("; frame-ancestors 'self' https://a.example https://b.example"));
}

} // namespace
} // namespace brume::test
