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

TEST_F(HttpTest, ASnapshotIsOneFrameOfTheAskedCamera) {
    const uint16_t port = serve();
    const auto plain = get(port, "/snapshot.jpg");
    EXPECT_EQ(plain.status, 200);
    EXPECT_EQ(plain.header("Content-Type"), "image/jpeg");
    const auto text = [](const HttpAnswer& answer) {
        return pictureText({reinterpret_cast<const uint8_t*>(answer.body.data()), answer.body.size()});
    };
    EXPECT_EQ(text(plain), "seq 1 eye 0 at 0 2 26 size 640x360 quality 90") << "as a picture at rest";
    EXPECT_EQ(plain.header("Brume-Size"), "640x360");
    EXPECT_EQ(plain.header("Brume-Error"), "0.0125");
    EXPECT_NE(plain.header("Brume-Tick"), "");
    EXPECT_EQ(plain.header("Brume-State").size(), 16u);
    EXPECT_EQ(plain.header("Brume-Asked"), "") << "it is as large as asked for";
    EXPECT_EQ(text(get(port, "/snapshot.jpg?w=320&h=200&quality=50&position=1,-2.5,3&target=0,0,0&fov=0.5&views=1")),
              "seq 1 eye 0 at 1 -2.5 3 size 320x200 quality 50");
    EXPECT_TRUE(eventually([&] { return audience->size() == 0; }));
}

TEST_F(HttpTest, ASizeIsCompletedOrCutDownAndSaid) {
    const uint16_t port = serve();
    EXPECT_EQ(get(port, "/snapshot.jpg?w=1280").header("Brume-Size"), "1280x720");
    EXPECT_EQ(get(port, "/snapshot.jpg?h=180").header("Brume-Size"), "320x180");
    const auto large = get(port, "/snapshot.jpg?w=3840");
    EXPECT_EQ(large.header("Brume-Size"), "1920x1080");
    EXPECT_EQ(large.header("Brume-Asked"), "3840x2160");
    EXPECT_NE(get(port, "/snapshot.jpg?fov=45").body.find("radians"), std::string::npos);
}

TEST_F(HttpTest, ASnapshotIsPngWhereOneIsAskedFor) {
    const uint16_t port = serve();
    for (const char* path : {"/snapshot.png", "/snapshot.jpg?format=png"})
        EXPECT_EQ(get(port, path).header("Content-Type"), "image/png") << path;
    const auto accepting = [&](const char* types) {
        return get(port, "/snapshot.jpg", fmt::format("Accept: {}\r\n", types)).header("Content-Type");
    };
    EXPECT_EQ(accepting("image/png"), "image/png");
    EXPECT_EQ(accepting("image/avif,image/png,image/*;q=0.8,*/*;q=0.5"), "image/jpeg") << "a browser's";
    EXPECT_EQ(get(port, "/stream.mjpg?format=png").status, 400);
}

TEST_F(HttpTest, PicturesThatCannotBeAreToldWhatMayBe) {
    const uint16_t port = serve();
    for (const char* query : {"w=0",
                              "w=15",
                              "h=99999",
                              "w=abc",
                              "w=",
                              "w=100x",
                              "w=nan",
                              "h=inf",
                              "quality=0",
                              "quality=101",
                              "fov=0",
                              "fov=9",
                              "fps=0",
                              "fps=1000",
                              "position=1,2",
                              "position=1,2,3,4",
                              "position=1,2,1e9",
                              "target=a,b,c",
                              "position=0,0,0&target=0,0,0",
                              "views=2",
                              "keep_size=2",
                              "w=100&w=200",
                              "format=gif",
                              "w=%4"})
        for (const char* path : {"/snapshot.jpg?", "/stream.mjpg?"}) {
            const auto answer = get(port, std::string(path) + query);
            EXPECT_EQ(answer.status, 400) << query;
            EXPECT_EQ(std::count(answer.body.begin(), answer.body.end(), '\n'), 1) << query;
        }
    for (const char* path : {"/snapshot.jpg", "/snapshot.png", "/stream.mjpg"}) {
        const auto head = get(port, path, "", "HEAD");
        EXPECT_EQ(head.status, 405) << path;
        EXPECT_EQ(head.header("Allow"), "GET") << path;
    }
    EXPECT_EQ(audience->size(), 0u);
}

// Programs add a number to an address so that nothing on the way keeps the picture.
TEST_F(HttpTest, WhatHasNoMeaningIsPassedOverAndNamed) {
    const uint16_t port = serve();
    for (const char* query : {"t=1", "_=1", "1764259200"})
        EXPECT_EQ(get(port, std::string("/snapshot.jpg?") + query).status, 200) << query;
    const auto wide = get(port, "/snapshot.jpg?width=320&two%0d%0aSet-Cookie:%20a=1&h=180");
    EXPECT_EQ(wide.status, 200);
    EXPECT_EQ(wide.header("Brume-Ignored"), "two??Set-Cookie??a width");
    EXPECT_EQ(wide.header("Set-Cookie"), "");
    EXPECT_EQ(wide.header("Brume-Size"), "320x180");
    std::string many = "/snapshot.jpg?";
    for (int i = 0; i < 100; ++i) many += fmt::format("{}x=1&", i);
    EXPECT_LT(get(port, many).header("Brume-Ignored").size(), 300u);
    Socket stream(port);
    stream.send("GET /stream.mjpg?t=1 HTTP/1.1\r\nHost: localhost\r\n\r\n");
    const std::string head = stream.readUntil("\r\n\r\n");
    EXPECT_NE(head.find("Brume-Ignored: t\r\n"), head.npos) << head;
    EXPECT_NE(head.find("X-Accel-Buffering: no\r\n"), head.npos) << head;
    EXPECT_EQ(get(port, "/pause?t=1", "", "POST").status, 200);
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

TEST_F(HttpTest, WithoutFramesPicturesEndIn503) {
    options.frame_wait = 200ms;
    const uint16_t port = serve();
    pauseRenderer();
    for (const char* path : {"/snapshot.jpg", "/stream.mjpg"}) {
        const auto answer = get(port, path);
        EXPECT_EQ(answer.status, 503) << path;
        EXPECT_NE(answer.header("Retry-After"), "") << path;
        EXPECT_NE(answer.body.find("/readyz"), std::string::npos) << path;
    }
    EXPECT_TRUE(eventually([&] { return audience->size() == 0; }));
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

TEST_F(HttpTest, WhoIsTurnedAwayIsToldWhyAndWhenToComeBack) {
    max_viewers = 1;
    const uint16_t port = serve();
    const auto seat = audience->join(nullptr).viewer;
    const auto full = get(port, "/snapshot.jpg");
    EXPECT_EQ(full.status, 503);
    EXPECT_NE(full.body.find("every place is taken"), std::string::npos) << full.body;
    EXPECT_EQ(full.header("Retry-After"), "5");
    audience->setMaxViewers(8);
    audience->setRoom(1);
    const auto late = get(port, "/snapshot.jpg");
    EXPECT_EQ(late.status, 503);
    EXPECT_NE(late.body.find("no time to draw"), std::string::npos) << late.body;
    audience->leave(seat);
}

// Reads one part of a stream: its headers, its bytes, and the boundary that follows.
std::string readPart(Socket& socket) {
    HttpAnswer part;
    part.head = fmt::format("\r\n{}", socket.readUntil("\r\n\r\n"));
    if (part.header("Content-Type") != "image/jpeg") return "no part: " + part.head;
    std::string body = socket.read(std::stoul(part.header("Content-Length")));
    EXPECT_EQ(socket.readUntil("--brume-frame\r\n"), "\r\n--brume-frame\r\n")
        << "at once, or a reader shows the frame late";
    return body;
}

TEST_F(HttpTest, AStreamIsPacedAndEndsWithItsReader) {
    const uint16_t port = serve();
    {
        const auto start = std::chrono::steady_clock::now();
        Socket socket(port);
        socket.send("GET /stream.mjpg?w=64&h=48&fps=20 HTTP/1.1\r\nHost: localhost\r\n\r\n");
        const std::string head = socket.readUntil("\r\n\r\n");
        EXPECT_NE(head.find("200 OK"), std::string::npos);
        EXPECT_NE(head.find("multipart/x-mixed-replace; boundary=brume-frame"), std::string::npos);
        EXPECT_EQ(socket.readUntil("--brume-frame\r\n"), "--brume-frame\r\n");
        for (int i = 0; i < 11; ++i) {
            const std::string jpeg = readPart(socket);
            EXPECT_NE(jpeg.find("size 64x48"), std::string::npos) << jpeg;
        }
        const uint64_t made = renderer->made;
        const auto took = std::chrono::steady_clock::now() - start;
        EXPECT_GE(took, 500ms) << "10 periods of 50 ms";
        EXPECT_EQ(audience->size(), 1u);
        EXPECT_LE(made, took / 50ms + 1) << "no frame is rendered before its time";
    }
    EXPECT_TRUE(eventually([&] { return audience->size() == 0; }));
}

TEST_F(HttpTest, AStalledStreamDelaysNobodyAndIsCut) {
    options.write_stall = 500ms;
    const uint16_t port = serve();
    renderer->jpeg_bytes = 2 << 20;
    Socket stalled(port, 4096);
    stalled.send("GET /stream.mjpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_TRUE(eventually([&] { return audience->size() == 1; }));
    for (int i = 0; i < 5; ++i) EXPECT_EQ(get(port, "/snapshot.jpg").status, 200);
    EXPECT_TRUE(eventually([&] { return audience->size() == 0; }));
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
