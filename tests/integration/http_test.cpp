// What the one port serves besides the WebSocket.
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test {
namespace {

client::Bytes bytesOf(const std::string& text) { return {text.begin(), text.end()}; }

struct Part {
    std::map<std::string, std::string> headers;
    std::string body;
};
// Of a stream, after its boundary.
Part readPart(HttpConnection& connection) {
    Part part;
    for (std::string line = connection.readLine(); !line.empty(); line = connection.readLine())
        part.headers[line.substr(0, line.find(": "))] = line.substr(line.find(": ") + 2);
    part.body = connection.readBytes(std::stoul(part.headers.at("Content-Length")));
    return part;
}

class Http : public testing::Test {
protected:
    static void SetUpTestSuite() {
        root_ = std::filesystem::temp_directory_path() / ("brume-http-" + std::to_string(getpid()));
        std::filesystem::create_directories(root_ / "assets");
        std::ofstream(root_ / "index.html") << "<!doctype html><title>brume</title>";
        std::ofstream(root_ / "assets" / "page.js") << "export {};";
        server_ = new RunningServer({"--web-root", root_.string()});
    }
    static void TearDownTestSuite() {
        delete server_;
        server_ = nullptr;
        std::filesystem::remove_all(root_);
    }
    static uint16_t port() { return server_->port(); }
    static client::Endpoint server() { return server_->endpoint(); }

private:
    static inline RunningServer* server_ = nullptr;
    static inline std::filesystem::path root_;
};

TEST_F(Http, HealthAndReadiness) {
    EXPECT_EQ(get(port(), "/healthz").status, 200);
    // Ready once frames can be had; the port is open a moment before.
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    int status = 0;
    while ((status = get(port(), "/readyz").status) == 503 && std::chrono::steady_clock::now() < deadline)
        std::this_thread::sleep_for(milliseconds(20));
    EXPECT_EQ(status, 200);
}

TEST_F(Http, ThePageIsServed) {
    const HttpReply page = get(port(), "/");
    EXPECT_EQ(page.status, 200);
    EXPECT_TRUE(page.headers.at("content-type").starts_with("text/html"));
    EXPECT_EQ(page.body, "<!doctype html><title>brume</title>");
    const HttpReply script = get(port(), "/assets/page.js");
    EXPECT_EQ(script.status, 200);
    EXPECT_TRUE(script.headers.at("content-type").starts_with("text/javascript"));
}

TEST_F(Http, WhatIsNotThereIsNotFound) {
    for (const char* target : {"/nothing", "/../../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd",
                               "/assets/../../../etc/passwd", "/assets"}) {
        const HttpReply reply = get(port(), target);
        EXPECT_EQ(reply.status, 404) << target;
        EXPECT_EQ(reply.body.find("root:"), std::string::npos) << target;
    }
}

TEST_F(Http, NonsenseIsRefused) {
    const auto status = [](const std::string& request) {
        HttpConnection connection(port());
        connection.send(request);
        return connection.readHead().status;
    };
    EXPECT_EQ(status("POST / HTTP/1.1\r\nHost: x\r\nContent-Length: 0\r\n\r\n"), 405);
    EXPECT_EQ(status("BRUME\r\n\r\n"), 400);
    EXPECT_EQ(status("GET /" + std::string(4096, 'a') + " HTTP/1.1\r\nHost: x\r\n\r\n"), 414);
    EXPECT_EQ(status("GET / HTTP/1.1\r\nHost: x\r\nX: " + std::string(16384, 'a') + "\r\n\r\n"), 431);
    EXPECT_EQ(get(port(), "/healthz").status, 200);
}

TEST_F(Http, MetricsCountWhatHappens) {
    const HttpReply reply = get(port(), "/metrics");
    EXPECT_EQ(reply.status, 200);
    EXPECT_TRUE(reply.headers.at("content-type").starts_with("text/plain"));

    const std::string sent = "brume_frames_total{fate=\"sent\"}";
    const auto before = metric(port(), sent);
    ASSERT_TRUE(before) << reply.body;
    Watcher watcher(server());
    watcher.look(lookAt({0, 2, 26}, {0, 0, 0}, 0.8f));
    ASSERT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() >= 5; }));
    EXPECT_GE(metric(port(), sent), *before + 5);
    EXPECT_EQ(metric(port(), "brume_viewers"), 1);
}

TEST_F(Http, MetricsTimeTheDeviceAndTheProcess) {
    const auto value = [](const std::string& name) { return metric(port(), name).value_or(-1); };
    const std::string cpu = "process_cpu_seconds_total", batches = "brume_batches_total",
                      views = "brume_device_seconds_total{part=\"view\"}",
                      shared = "brume_device_seconds_total{part=\"shared\"}",
                      of_frames = "brume_stage_seconds_sum{stage=\"gpu\"}";
    const auto begin = std::chrono::steady_clock::now();
    const double cpu_before = value(cpu), batches_before = value(batches), views_before = value(views),
                 shared_before = value(shared);
    ASSERT_GE(std::min({cpu_before, batches_before, views_before, shared_before}), 0) << "all are there";
    {
        Watcher watcher(server());
        watcher.look(lookAt({0, 2, 26}, {0, 0, 0}, 0.8f));
        ASSERT_TRUE(watch({&watcher}, [&] { return watcher.frames.size() >= 5; }));
    }
    EXPECT_GE(value(batches), batches_before + 5); // a batch has one frame of a viewer at most
    EXPECT_GT(value(views), views_before);
    EXPECT_GT(value(shared), shared_before);
    EXPECT_GT(value(cpu), cpu_before);
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    EXPECT_LE(value(cpu) - cpu_before, passed.count() * std::thread::hardware_concurrency() + 0.1);
    EXPECT_GT(value("process_resident_memory_bytes"), 1e6);
    {
        std::vector<std::unique_ptr<HttpConnection>> open;
        for (int i = 0; i < 20; ++i) open.push_back(std::make_unique<HttpConnection>(port()));
        EXPECT_GT(value("process_open_fds"), 20 + 3); // with the listener, the log and standard output
    }
    EXPECT_LT(value("process_open_fds"), value("process_max_fds"));
    // The second in which frames were drawn counts as soon as it is over. Passes of one queue do not overlap; a batch
    // that began before these ten seconds counts whole.
    const std::string busy = "brume_device_busy_ratio";
    while (value(busy) <= 0 && std::chrono::steady_clock::now() < begin + kPatience)
        std::this_thread::sleep_for(milliseconds(50));
    EXPECT_GT(value(busy), 0);
    EXPECT_LE(value(busy), 1.1);
    // Counted by batches and counted by frames, device time of views is the same once the last frame is encoded.
    const auto deadline = begin + kPatience;
    while (std::abs(value(views) / value(of_frames) - 1) > 1e-5 && std::chrono::steady_clock::now() < deadline)
        std::this_thread::sleep_for(milliseconds(20));
    EXPECT_NEAR(value(views), value(of_frames), 1e-5 * value(views)); // floats of milliseconds
}

TEST_F(Http, ASnapshotIsOnePicture) {
    const HttpReply reply = get(port(), "/snapshot.jpg?w=160&h=96");
    ASSERT_EQ(reply.status, 200) << reply.body;
    EXPECT_EQ(reply.headers.at("content-type"), "image/jpeg");
    EXPECT_GT(contrast(decoded(bytesOf(reply.body), 160, 96)), 8);
    EXPECT_EQ(get(port(), "/snapshot.jpg?w=potato").status, 400);
}

TEST_F(Http, SnapshotsAndStreamsShowHowAPictureIsMade) {
    // Paused, so that only the view differs.
    const auto post = [&](const std::string& target) {
        HttpConnection connection(port());
        connection.send("POST " + target + " HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 0\r\n\r\n");
        return connection.readReply();
    };
    ASSERT_EQ(post("/pause").status, 200);
    const auto at = [&](const std::string& view) { return get(port(), "/snapshot.png?w=160&h=96" + view); };
    const HttpReply picture = at("");
    ASSERT_EQ(picture.status, 200) << picture.body;
    EXPECT_EQ(at("&view=picture").body, picture.body);
    std::map<std::string, std::string> seen{{picture.body, "picture"}};
    for (const char* view : {"wasted", "overdraw", "particles", "rays", "depth", "shadow", "light", "error"}) {
        const HttpReply reply = at("&view=" + std::string(view));
        ASSERT_EQ(reply.status, 200) << view << reply.body;
        EXPECT_EQ(reply.headers.at("brume-state"), picture.headers.at("brume-state"));
        const auto [same, is_new] = seen.emplace(reply.body, view);
        EXPECT_TRUE(is_new) << view << " is as " << same->second;
    }
    EXPECT_EQ(at("").body, picture.body) << "the picture is as before";
    const HttpReply wrong = at("&view=xray");
    EXPECT_EQ(wrong.status, 400);
    EXPECT_EQ(wrong.body, "view must be one of picture wasted overdraw particles rays depth shadow light error\n");
    EXPECT_EQ(get(port(), "/stream.mjpg?view=xray").status, 400);
    ASSERT_EQ(post("/resume").status, 200);
}

// One state gives one picture, whoever else is served meanwhile and whatever they cost.
TEST(Snapshots, OfOneStateAreTheSameBytesAndGiveUpNothing) {
    Process server({BRUME_SERVER, "--scene", "cloud", "--port", "0", "--paused", "--ahead", "off", "--frame-budget",
                    "20", "--max-viewers", "16"});
    const auto line = server.lineStarting("listening on http://127.0.0.1:");
    ASSERT_TRUE(line) << server.err();
    const auto at = uint16_t(std::stoi(*line));
    const std::string path = "/snapshot.jpg?w=480&h=270&position=3,4,20&target=0,0,0";
    const HttpReply first = get(at, path);
    ASSERT_EQ(first.status, 200) << first.body;
    EXPECT_LE(std::stof(first.headers.at("brume-error")), 0.005f);
    {
        HttpConnection stream(at); // a viewer that is always there
        stream.send("GET /stream.mjpg?w=640&h=360 HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
        ASSERT_EQ(stream.readHead().status, 200);
        for (int i = 0; i < 12; ++i) {
            const HttpReply again = get(at, path);
            ASSERT_EQ(again.status, 200) << again.body;
            EXPECT_EQ(again.headers.at("brume-state"), first.headers.at("brume-state"));
            EXPECT_TRUE(again.body == first.body) << "picture " << i << " differs";
            const HttpReply other = get(at, "/snapshot.jpg?w=320&target=0,0,0&position=4,20," + std::to_string(i));
            EXPECT_EQ(other.status, 200);
        }
    }
    EXPECT_EQ(metric(at, "brume_plan_relaxed"), 0) << "snapshots push nobody into giving up";
}

// What does not change is not drawn again; its bytes are sent again each second, so that players do not give up.
TEST(Snapshots, AStreamAtRestRepeatsItsLastPicture) {
    Process server({BRUME_SERVER, "--scene", "cloud", "--port", "0", "--paused", "--ahead", "off"});
    const auto line = server.lineStarting("listening on http://127.0.0.1:");
    ASSERT_TRUE(line) << server.err();
    const auto at = uint16_t(std::stoi(*line));
    HttpConnection stream(at);
    stream.send("GET /stream.mjpg?w=160&h=96 HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    const HttpReply head = stream.readHead();
    ASSERT_EQ(head.status, 200);
    std::string last;
    double drawn = -1;
    for (int i = 0, same = 0; same < 3; ++i) {
        ASSERT_LT(i, 20) << "it never rests";
        stream.readLine(); // the boundary
        const std::string body = readPart(stream).body;
        stream.readLine();
        same = body == last ? same + 1 : 0;
        if (same == 1) drawn = *metric(at, "brume_frames_total{fate=\"rendered\"}");
        last = body;
    }
    EXPECT_EQ(*metric(at, "brume_frames_total{fate=\"rendered\"}"), drawn);
}

TEST_F(Http, AStreamIsManyPictures) {
    HttpConnection connection(port());
    connection.send("GET /stream.mjpg?w=160&h=96&fps=20 HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    const HttpReply head = connection.readHead();
    ASSERT_EQ(head.status, 200);
    const std::string type = head.headers.at("content-type"), prefix = "multipart/x-mixed-replace; boundary=";
    ASSERT_TRUE(type.starts_with(prefix)) << type;
    const std::string boundary = "--" + type.substr(prefix.size());

    const auto start = std::chrono::steady_clock::now();
    constexpr int parts = 6;
    for (int i = 0; i < parts; ++i) {
        ASSERT_EQ(connection.readLine(), boundary);
        const Part part = readPart(connection);
        EXPECT_EQ(part.headers.at("Content-Type"), "image/jpeg");
        EXPECT_EQ(part.headers.at("Brume-Size"), "160x96");
        EXPECT_EQ(part.headers.at("Brume-State").size(), 16u);
        EXPECT_GT(contrast(decoded(bytesOf(part.body), 160, 96)), 8);
        ASSERT_EQ(connection.readLine(), "");
    }
    // No faster than asked for: between the first and the last lie (parts - 1) periods, one of which may have begun
    // before.
    EXPECT_GE(std::chrono::steady_clock::now() - start, milliseconds(1000 / 20 * (parts - 2)));
}

} // namespace
} // namespace brume::test
