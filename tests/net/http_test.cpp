// The routes of the one port, and what they refuse.
#include <filesystem>
#include <fstream>

#include <nlohmann/json.hpp>

#include "tests/net/fixture.h"

namespace brume::test {
namespace {

namespace fs = std::filesystem;

class HttpTest : public ServerTest { // NOLINT(cppcoreguidelines-virtual-class-destructor): googletest owns it
protected:
    fs::path folder; // holds page/ (served) and secret.txt (not)

    HttpTest() {
        std::string name = (fs::temp_directory_path() / "brume-http-test-XXXXXX").string();
        folder = mkdtemp(name.data());
        write("page/index.html", "<!doctype html><title>brume</title>");
        write("page/assets/app-1a2b.js", "let cloud = 1;");
        write("page/.env", "hidden");
        write("page/.git/config", "hidden");
        write("secret.txt", "secret");
        fs::create_symlink(folder / "secret.txt", folder / "page/link.txt");
        fs::create_directory_symlink(folder, folder / "page/up");
        options.web_root = folder / "page";
        options.frame_wait = 2s;
    }
    ~HttpTest() override { fs::remove_all(folder); }

    void write(const std::string& path, std::string_view text) {
        fs::create_directories((folder / path).parent_path());
        std::ofstream(folder / path) << text;
    }
};

TEST_F(HttpTest, ThePageIsServedWithTypesTagsAndLengths) {
    const uint16_t port = serve();
    const auto page = get(port, "/");
    EXPECT_EQ(page.status, 200);
    EXPECT_EQ(page.header("Content-Type"), "text/html; charset=utf-8");
    EXPECT_EQ(page.header("Cache-Control"), "no-cache");
    EXPECT_EQ(page.header("X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(page.body, "<!doctype html><title>brume</title>");
    EXPECT_EQ(get(port, "/index.html?x=1").body, page.body);

    const auto script = get(port, "/assets/app-1a2b.js");
    EXPECT_EQ(script.status, 200);
    EXPECT_EQ(script.header("Content-Type"), "text/javascript; charset=utf-8");
    EXPECT_NE(script.header("Cache-Control").find("immutable"), std::string::npos);
    EXPECT_EQ(get(port, "/assets/app%2D1a2b.js").body, script.body);

    const auto known = get(port, "/", "If-None-Match: " + page.header("ETag") + "\r\n");
    EXPECT_EQ(known.status, 304);
    EXPECT_EQ(known.body, "");
    EXPECT_EQ(known.header("Content-Length"), "");
    write("page/index.html", "changed, and longer than it was before");
    EXPECT_EQ(get(port, "/", "If-None-Match: " + page.header("ETag") + "\r\n").status, 200);

    const auto head = get(port, "/assets/app-1a2b.js", "", "HEAD");
    EXPECT_EQ(head.status, 200);
    EXPECT_EQ(head.header("Content-Length"), std::to_string(script.body.size()));
}

TEST_F(HttpTest, NothingOutsideThePageIsServed) {
    const uint16_t port = serve();
    for (const char* path : {"/../secret.txt",
                             "/%2e%2e/secret.txt",
                             "/..%2fsecret.txt",
                             "/assets/../../secret.txt",
                             "/assets/%2e%2e/%2e%2e/secret.txt",
                             "/..\\secret.txt",
                             "/..%5csecret.txt",
                             "//secret.txt",
                             "/./index.html",
                             "/link.txt",
                             "/up/secret.txt",
                             "/.env",
                             "/.git/config",
                             "/assets",
                             "/assets/",
                             "/index.html/",
                             "/index.html%00.png",
                             "/%",
                             "/%zz",
                             "/nothing.html",
                             "/etc/passwd",
                             "/%2fetc%2fpasswd",
                             "/snapshot.jpg/",
                             "/ws/"}) {
        const auto answer = get(port, path);
        EXPECT_EQ(answer.status, 404) << path;
        EXPECT_EQ(answer.body.find("secret"), std::string::npos) << path;
        EXPECT_EQ(std::count(answer.body.begin(), answer.body.end(), '\n'), 1) << "one clear line for " << path;
    }
}

TEST_F(HttpTest, AMissingPageSaysHowToBuildIt) {
    options.web_root = folder / "nowhere";
    const auto answer = get(serve(), "/");
    EXPECT_EQ(answer.status, 404);
    EXPECT_NE(answer.body.find("./dev"), std::string::npos);
}

TEST_F(HttpTest, MeasuredErrorsAreInMetricsAndViewersOnceTheyAreKnown) {
    const uint16_t port = serve();
    const auto first = watch(), second = watch();
    for (const auto& client : {first.get(), second.get()}) {
        client->pose(1);
        ASSERT_TRUE(client->next<wire::Frame>());
    }
    pauseRenderer();
    std::vector<std::shared_ptr<Viewer>> viewers;
    audience->list(viewers);
    const uint32_t a = viewers.at(0)->id(), b = viewers.at(1)->id();
    auto report = std::make_shared<SceneReport>(*audience->report());
    const auto publish = [&](std::vector<ViewError> errors) {
        report->errors = std::move(errors);
        audience->publish(std::make_shared<const SceneReport>(*report));
    };
    const ErrorEstimate small{.pixels = 400, .rmse = 0.25, .low = 0.125, .high = 0.5, .bias = -0.0625, .law = 0.375},
        large{.pixels = 500, .rmse = 0.5, .low = 0.25, .high = 0.75, .bias = 0.125, .law = 0.625},
        few{.pixels = ErrorEstimate::kLeast - 1, .rmse = 1};

    publish({{a, "slabs", few}});
    for (const char* name : {"brume_picture_error", "brume_picture_bias"})
        EXPECT_EQ(get(port, "/metrics").body.find(name), std::string::npos) << "of too few pixels";
    EXPECT_EQ(nlohmann::json::parse(get(port, "/viewers").body)["viewers"][0]["error"], nlohmann::json::object());

    publish({{a, "slabs", small}, {a, "grid", few}, {b, "slabs", large}});
    const std::string text = get(port, "/metrics").body;
    for (const char* line :
         {"\nbrume_picture_error 0.5\n", "\nbrume_picture_error_low 0.25\n", "\nbrume_picture_error_high 0.75\n",
          "\nbrume_picture_error_predicted 0.625\n", "\nbrume_picture_bias 0.125\n"})
        EXPECT_NE(text.find(line), text.npos) << line << text;
    const auto said = nlohmann::json::parse(get(port, "/viewers").body)["viewers"];
    const auto expected = nlohmann::json::parse(
        R"({"slabs": {"relative_rmse": 0.25, "low": 0.125, "high": 0.5, "predicted": 0.375, "bias": -0.0625,
                      "pixels": 400}})");
    EXPECT_EQ(said[0]["error"], expected);
    EXPECT_EQ(said[1]["error"]["slabs"]["relative_rmse"], 0.5);
}

TEST_F(HttpTest, HealthReadinessAndMetrics) {
    const uint16_t port = serve();
    EXPECT_EQ(get(port, "/healthz").body, "ok\n");
    EXPECT_EQ(get(port, "/readyz").status, 200);
    audience->ready = false;
    EXPECT_EQ(get(port, "/readyz").status, 503);
    EXPECT_EQ(get(port, "/healthz").status, 200);
    audience->ready = true;

    const auto client = watch();
    client->pose(1);
    ASSERT_TRUE(client->next<wire::Frame>());
    client->sendMessage(2, std::vector<uint8_t>{1});
    ASSERT_TRUE(client->next<wire::Error>());
    const auto answer = get(port, "/metrics");
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.header("Content-Type"), "text/plain; version=0.0.4; charset=utf-8");
    const char* const build = "brume_build_info{version=\"" BRUME_VERSION "\",";
    for (const char* line :
         {build, "brume_viewers 1", "brume_pass_seconds{pass=\"medium\"} 0.00725",
          "brume_refused_total{reason=\"malformed\"} 1",
          "brume_http_requests_total{route=\"healthz\",status=\"200\"} 2",
          "brume_http_requests_total{route=\"readyz\",status=\"503\"} 1", "brume_ready 1", "brume_particles 500",
          "# TYPE brume_stage_seconds histogram", "brume_stage_seconds_bucket{stage=\"encode\",le=\"0.004\"}",
          "brume_frames_total{fate=\"rendered\"}", "brume_frames_total{fate=\"superseded\"}",
          "brume_tick_seconds_count", "# TYPE process_cpu_seconds_total counter", "process_resident_memory_bytes ",
          "process_open_fds ", "process_max_fds ", "brume_device_busy_ratio 0"})
        EXPECT_NE(answer.body.find(std::string("\n") + line), std::string::npos) << line << " in\n" << answer.body;
}

TEST_F(HttpTest, WrongRequestsAreToldSoInOneLine) {
    const uint16_t port = serve();
    const auto answerTo = [&](const std::string& request) {
        Socket socket(port);
        socket.send(request);
        const auto answer = readAnswer(socket);
        EXPECT_EQ(std::count(answer.body.begin(), answer.body.end(), '\n'), 1) << request.substr(0, 60);
        EXPECT_TRUE(socket.closesWithin(3s)) << request.substr(0, 60);
        return answer.status;
    };
    EXPECT_EQ(answerTo("hello there\r\n\r\n"), 400);
    EXPECT_EQ(answerTo("GET http://elsewhere/ HTTP/1.1\r\nHost: elsewhere\r\n\r\n"), 400);
    EXPECT_EQ(answerTo("POST / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 3\r\n\r\nabc"), 405);
    EXPECT_EQ(answerTo("DELETE / HTTP/1.1\r\nHost: localhost\r\n\r\n"), 405);
    EXPECT_EQ(answerTo("POST /puase HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n"), 404);
    EXPECT_EQ(answerTo("GET / HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000000\r\n\r\nabc"), 413);
    EXPECT_EQ(answerTo("GET / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n"), 413);
    EXPECT_EQ(answerTo("POST /cloud HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: gzip, chunked\r\n\r\n0\r\n\r\n"),
              501);
    EXPECT_EQ(
        answerTo("GET / HTTP/1.1\r\nHost: localhost\r\nOrigin: http://localhost\r\nOrigin: https://a.example\r\n\r\n"),
        400);
    EXPECT_EQ(answerTo("GET /" + std::string(3000, 'a') + " HTTP/1.1\r\nHost: localhost\r\n\r\n"), 414);
    EXPECT_EQ(answerTo("GET /" + std::string(20000, 'a') + " HTTP/1.1\r\nHost: localhost\r\n\r\n"), 414);
    EXPECT_EQ(answerTo("GET / HTTP/1.1\r\nHost: localhost\r\nCookie: " + std::string(20000, 'a') + "\r\n\r\n"), 431);
    EXPECT_EQ(answerTo(std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", 11)), 400) << "TLS on a plain port";
    EXPECT_EQ(get(port, "/").status, 200);
}

TEST_F(HttpTest, AConnectionCarriesSeveralRequests) {
    Socket socket(serve());
    const std::string request = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
    socket.send(request + request);
    EXPECT_EQ(readAnswer(socket).body, "ok\n");
    EXPECT_EQ(readAnswer(socket).body, "ok\n");
    socket.send("HEAD / HTTP/1.1\r\nHost: localhost\r\n\r\n" + request);
    EXPECT_EQ(readAnswer(socket, true).status, 200);
    EXPECT_EQ(readAnswer(socket).body, "ok\n");
    socket.send("GET /healthz HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
    EXPECT_EQ(readAnswer(socket).status, 200);
    EXPECT_TRUE(socket.closesWithin(3s));
}

// Many programs send a few bytes with every POST.
TEST_F(HttpTest, AShortBodyIsPassedOver) {
    const uint16_t port = serve();
    Socket socket(port);
    const auto post = [&](const std::string& path, const std::string& body) {
        socket.send(fmt::format("POST {} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {}\r\n\r\n{}", path,
                                body.size(), body));
        return readAnswer(socket);
    };
    EXPECT_EQ(post("/pause", "{}").body, "paused\n");
    EXPECT_EQ(post("/resume", std::string(4096, 'x')).body, "running\n") << "on the same connection";
    EXPECT_EQ(post("/pause", std::string(4097, 'x')).status, 413);
}

TEST_F(HttpTest, TheSceneIsPausedForWhoMayDoSo) {
    const uint16_t port = serve();
    const auto paused = get(port, "/pause", "", "POST");
    EXPECT_EQ(paused.status, 200);
    EXPECT_EQ(paused.body, "paused\n");
    EXPECT_EQ(paused.header("Brume-State").size(), 16u);
    const auto commands = renderer->commands();
    ASSERT_EQ(commands.size(), 1u);
    const auto& set = std::get<Set>(commands[0].body);
    EXPECT_EQ(set.changes.at(0).setting->path, "simulation.paused");
    EXPECT_EQ(set.changes.at(0).value, SettingValue(true));
    EXPECT_EQ(get(port, "/resume", "", "POST").body, "running\n");

    const auto looked = get(port, "/pause");
    EXPECT_EQ(looked.status, 405) << "a link must not pause";
    EXPECT_EQ(looked.header("Allow"), "POST");
    EXPECT_EQ(get(port, "/pause", "Sec-Fetch-Site: cross-site\r\n", "POST").status, 403);
    pauseRenderer();
    EXPECT_EQ(get(port, "/pause", "", "POST").status, 503) << "nobody takes the command";
}

// Looking at /viewers tells who is hidden, and neither addresses nor tokens.
TEST_F(HttpTest, ViewersSayWhoIsHidden) {
    const uint16_t port = serve();
    const auto seen = watch(), hidden = watch();
    seen->pose(1);
    hidden->pose(1, {0, 0, 10}, 0, 0, true);
    ASSERT_TRUE(eventually([&] { return get(port, "/viewers").body.find("\"hidden\":true") != std::string::npos; }));
    const std::string body = get(port, "/viewers").body;
    EXPECT_NE(body.find("\"hidden\":false"), std::string::npos) << body;
    EXPECT_EQ(body.find("127.0.0.1"), std::string::npos) << body;
    EXPECT_EQ(body.find("owner"), std::string::npos) << body;
}

} // namespace
} // namespace brume::test
