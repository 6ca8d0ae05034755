// Pictures over HTTP: one, or a stream of them, as programs of all kinds ask for them.
#include "tests/net/fixture.h"

namespace brume::test {
namespace {

class PictureTest : public ServerTest { // NOLINT(cppcoreguidelines-virtual-class-destructor): googletest owns it
protected:
    PictureTest() { options.frame_wait = 2s; }
};

TEST_F(PictureTest, ASnapshotIsOneFrameOfTheAskedCamera) {
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

TEST_F(PictureTest, ASizeIsCompletedOrCutDownAndSaid) {
    const uint16_t port = serve();
    EXPECT_EQ(get(port, "/snapshot.jpg?w=1280").header("Brume-Size"), "1280x720");
    EXPECT_EQ(get(port, "/snapshot.jpg?h=180").header("Brume-Size"), "320x180");
    const auto large = get(port, "/snapshot.jpg?w=3840");
    EXPECT_EQ(large.header("Brume-Size"), "1920x1080");
    EXPECT_EQ(large.header("Brume-Asked"), "3840x2160");
    EXPECT_NE(get(port, "/snapshot.jpg?fov=45").body.find("radians"), std::string::npos);
}

TEST_F(PictureTest, ASnapshotIsPngWhereOneIsAskedFor) {
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

TEST_F(PictureTest, PicturesThatCannotBeAreToldWhatMayBe) {
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
    for (const char* path : {"/snapshot.jpg", "/snapshot.png", "/stream.mjpg"})
        for (const char* method : {"HEAD", "POST", "PUT", "DELETE"}) {
            const auto answer = get(port, path, "Content-Length: 0\r\n", method);
            EXPECT_EQ(answer.status, 405) << method << ' ' << path;
            EXPECT_EQ(answer.header("Allow"), "GET") << method << ' ' << path;
        }
    EXPECT_EQ(audience->size(), 0u);
}

// Programs add a number to an address so that nothing on the way keeps the picture.
TEST_F(PictureTest, WhatHasNoMeaningIsPassedOverAndNamed) {
    const uint16_t port = serve();
    for (const char* query :
         {"t=1", "_=1", "1764259200", "", "&&", "t", "utm_source=x&utm_medium=y", "cb=%F0%9F%8C%AB"})
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

TEST_F(PictureTest, WithoutFramesPicturesEndIn503) {
    options.frame_wait = 200ms;
    const uint16_t port = serve();
    pauseRenderer();
    for (const char* path : {"/snapshot.jpg", "/stream.mjpg"}) {
        const auto answer = get(port, path);
        EXPECT_EQ(answer.status, 503) << path;
        EXPECT_NE(answer.header("Retry-After"), "") << path;
        EXPECT_NE(answer.body.find("ask again"), std::string::npos) << path;
    }
    EXPECT_TRUE(eventually([&] { return audience->size() == 0; }));
}

TEST_F(PictureTest, WhoIsTurnedAwayIsToldWhyAndWhenToComeBack) {
    max_viewers = 1;
    const uint16_t port = serve();
    const auto seat = audience->join(nullptr).viewer;
    const auto full = get(port, "/snapshot.jpg");
    EXPECT_EQ(full.status, 503);
    EXPECT_NE(full.body.find("every place is taken"), std::string::npos) << full.body;
    EXPECT_EQ(full.header("Retry-After"), "5");
    audience->setMaxViewers(8);
    audience->setTimeFor(1);
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

TEST_F(PictureTest, AStreamIsPacedAndEndsWithItsReader) {
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

TEST_F(PictureTest, AStalledStreamDelaysNobodyAndIsCut) {
    options.write_stall = 500ms;
    const uint16_t port = serve();
    renderer->jpeg_bytes = 2 << 20;
    Socket stalled(port, 4096);
    stalled.send("GET /stream.mjpg HTTP/1.1\r\nHost: localhost\r\n\r\n");
    ASSERT_TRUE(eventually([&] { return audience->size() == 1; }));
    for (int i = 0; i < 5; ++i) EXPECT_EQ(get(port, "/snapshot.jpg").status, 200);
    EXPECT_TRUE(eventually([&] { return audience->size() == 0; }));
}

} // namespace
} // namespace brume::test
