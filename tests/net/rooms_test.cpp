// Rooms over real sockets: each has its own scene and people, and answers what the one at "/" answers.
#include "server/net/rooms.h"

#include "server/net/routes.h"
#include "server/net/token.h"
#include "tests/net/session_fixture.h"

namespace brume::test {
namespace {

using net::RoomPath;

struct RoomsTest : ServerTest {
    std::optional<Audience> lab_audience;
    std::optional<Metrics> lab_metrics;
    std::optional<FakeRenderer> lab_renderer;

    uint16_t serveTwo() {
        const uint16_t port = serve();
        Scene scene;
        scene.name = "lab scene";
        lab_audience.emplace(ServerFacts{"test device", {"sphere"}}, sceneFacts(scene), 2, 2);
        lab_metrics.emplace();
        lab_renderer.emplace(*lab_audience, *lab_metrics);
        server->rooms().add(std::make_shared<net::Room>("lab", *lab_audience, *lab_metrics));
        EXPECT_TRUE(eventually([&] { return lab_audience->report()->tick > 0; }));
        return port;
    }
    void TearDown() override {
        server.reset();
        lab_renderer.reset();
        renderer.reset();
    }
    // Welcomed in the room "lab".
    std::unique_ptr<WsClient> watchLab() const {
        auto client =
            std::make_unique<WsClient>(server->port(), 0, "Sec-WebSocket-Protocol: brume.v1\r\n", "", "/r/lab/ws");
        EXPECT_EQ(client->handshake.status, 101) << client->handshake.body;
        client->hello();
        return client;
    }
};

TEST(RoomPaths, NameARoomAndAPathInIt) {
    const auto is = [](std::string_view path, std::string_view room, std::string_view rest) {
        const RoomPath in = net::roomPathOf(path);
        EXPECT_EQ(in.room, room) << path;
        EXPECT_EQ(in.path, rest) << path;
    };
    is("/", "", "/");
    is("/ws", "", "/ws");
    is("/r/lab/", "lab", "/");
    is("/r/lab/ws", "lab", "/ws");
    is("/r/lab/assets/a.js", "lab", "/assets/a.js");
    is("/r/lab", "lab", "");
    is("/r/", "", "/r/");
    is("/r//ws", "", "/r//ws");
    is("/r/../ws", "", "/r/../ws");
    is("/r/a%2fb/ws", "", "/r/a%2fb/ws");
    is("/r/r/r/ws", "r", "/r/ws");
    is("/rooms", "", "/rooms");
    EXPECT_FALSE(net::isRoomName(std::string(net::kMostRoomName + 1, 'a')));
    EXPECT_FALSE(net::isRoomName("z\xc3\xb6"));
    EXPECT_EQ(net::routeOf("/r/lab/ws"), net::routeOf("/ws"));
    EXPECT_EQ(net::routeOf("/r/lab/rooms"), nullptr) << "rooms have no rooms";
    EXPECT_EQ(net::routeOf("/r/lab/r/lab/ws"), nullptr);
}

TEST(RoomPaths, OfAnotherServerAreMadeOfItsUrl) {
    const auto is = [](const char* url, const char* room) { EXPECT_EQ(net::roomUrl(url, "lab"), room) << url; };
    is("http://b.example", "http://b.example/r/lab/");
    is("http://b.example/", "http://b.example/r/lab/");
    is("https://b.example:8080", "https://b.example:8080/r/lab/");
    is("http://[::1]:8080", "http://[::1]:8080/r/lab/");
    is("https://b.example/clouds/brume", "https://b.example/clouds/brume/r/lab/");
    is("https://b.example/clouds/brume/", "https://b.example/clouds/brume/r/lab/");
    is("https://b.example/index.html", "https://b.example/r/lab/");
    is("https://b.example/ws", "https://b.example/r/lab/");
    is("https://b.example?token_url=/token", "https://b.example/r/lab/?token_url=/token");
    is("https://b.example/a#at=1/2", "https://b.example/a/r/lab/#at=1/2");
    is("ws://b.example", "ws://b.example/r/lab/ws");
    is("ws://b.example/ws", "ws://b.example/r/lab/ws");
    is("wss://b.example/clouds/ws", "wss://b.example/clouds/r/lab/ws");
    is("", "");
    EXPECT_EQ(net::roomUrl("http://b.example", ""), "http://b.example");
}

TEST_F(RoomsTest, EachHasItsOwnSceneAndPeople) {
    serveTwo();
    const auto home = watch();
    const auto lab = watchLab();
    const auto welcome = lab->next<wire::Welcome>();
    ASSERT_TRUE(welcome);
    EXPECT_EQ(welcome->parsed->as<wire::Welcome>()->scene()->str(), "lab scene");
    EXPECT_EQ(audience->size(), 1u);
    EXPECT_EQ(lab_audience->size(), 1u);
    lab->pose(1);
    EXPECT_TRUE(frameOf(*lab, 1));
    // A command reaches its own room's simulation alone.
    lab->say(
        [](auto& b) { return wire::CreateInput(b, 1, 0, wire::Command::Restart, wire::CreateRestart(b).Union()); });
    EXPECT_TRUE(eventually([&] { return lab_renderer->commands().size() == 1; }));
    EXPECT_TRUE(renderer->commands().empty());
}

TEST_F(RoomsTest, AnswerWhatTheOneAtTheRootAnswers) {
    const uint16_t port = serveTwo();
    EXPECT_EQ(get(port, "/r/lab/healthz").status, 200);
    EXPECT_EQ(get(port, "/r/lab/readyz").status, 200);
    lab_audience->ready = false;
    EXPECT_EQ(get(port, "/r/lab/readyz").status, 503);
    EXPECT_EQ(get(port, "/readyz").status, 200);
    EXPECT_EQ(get(port, "/r/lab/snapshot.jpg").status, 200);
    EXPECT_NE(get(port, "/r/lab/scene.toml").body.find("lab scene"), std::string::npos);
    const HttpAnswer slash = get(port, "/r/lab?position=0,6,26");
    EXPECT_EQ(slash.status, 308);
    EXPECT_EQ(slash.header("Location"), "lab/?position=0,6,26");
    for (const char* path : {"/r/none/", "/r/none/ws", "/r/none", "/r/none/snapshot.jpg"}) {
        const HttpAnswer answer = get(port, path);
        EXPECT_EQ(answer.status, 404) << path;
        EXPECT_EQ(answer.header("Brume-Refused"), "room") << path;
    }
}

TEST_F(RoomsTest, AreListedAndCounted) {
    const uint16_t port = serveTwo();
    const auto lab = watchLab();
    ASSERT_TRUE(lab->next<wire::Welcome>());
    const std::string list = get(port, "/rooms").body;
    EXPECT_NE(list.find(R"({"name":"","href":"./","scene":"test scene","viewers":0)"), std::string::npos) << list;
    EXPECT_NE(list.find(R"({"name":"lab","href":"r/lab/","scene":"lab scene","viewers":1)"), std::string::npos) << list;
    const std::string all = get(port, "/metrics").body, own = get(port, "/r/lab/metrics").body;
    EXPECT_NE(all.find("\nbrume_viewers 0"), std::string::npos);
    EXPECT_NE(all.find("\nbrume_viewers{room=\"lab\"} 1"), std::string::npos);
    EXPECT_NE(own.find("\nbrume_viewers 1"), std::string::npos);
    EXPECT_EQ(all.find("# TYPE brume_viewers "), all.rfind("# TYPE brume_viewers ")) << "one family, told once";
}

TEST_F(RoomsTest, OperatorsWishThemOpenedAndClosed) {
    const uint16_t port = serveTwo();
    const auto post = [&](const std::string& target) { return get(port, target, "", "POST"); };
    for (const char* wrong : {"/rooms/open", "/rooms/open?name=a", "/rooms/open?name=a/b&scene=x", "/rooms/close",
                              "/rooms/close?name=a&scene=x", "/rooms/open?name=%00&scene=x"})
        EXPECT_EQ(post(wrong).status, 400) << wrong;
    EXPECT_EQ(get(port, "/rooms/open?name=a&scene=x").status, 405);
    // Who keeps rooms answers.
    std::vector<net::RoomWish> wishes;
    net::Rooms& rooms = server->rooms();
    rooms.requests().serve([&] {
        std::thread([&] {
            while (const auto request = rooms.requests().take()) {
                wishes.push_back(request->wish);
                request->answer(request->wish.name == "bad" ? "no scene of that name" : "");
            }
        }).detach();
    });
    HttpAnswer answer = post("/rooms/open?name=one&scene=cloud");
    EXPECT_EQ(answer.status, 201);
    EXPECT_EQ(answer.body, "room 'one' is open at /r/one/\n");
    answer = post("/rooms/open?name=bad&scene=none");
    EXPECT_EQ(answer.status, 422);
    EXPECT_EQ(answer.body, "no scene of that name\n");
    EXPECT_EQ(post("/rooms/close?name=one").status, 200);
    ASSERT_EQ(wishes.size(), 3u);
    EXPECT_EQ(wishes[0].scene, "cloud");
    EXPECT_EQ(wishes[2].kind, net::RoomWish::Kind::close);
    rooms.requests().serve(nullptr);
}

TEST_F(RoomsTest, WhoIsInARoomThatIsRemovedKeepsItUntilItLeaves) {
    const uint16_t port = serveTwo();
    auto lab = watchLab();
    ASSERT_TRUE(lab->next<wire::Welcome>());
    const std::weak_ptr<net::Room> room = server->rooms().find("lab");
    Socket idle(port); // that asked for the room before, and is kept alive
    idle.send("GET /r/lab/healthz HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_EQ(readAnswer(idle).status, 200);
    server->rooms().remove("lab");
    EXPECT_FALSE(room.expired());
    EXPECT_EQ(get(port, "/r/lab/healthz").status, 404);
    lab.reset();
    EXPECT_TRUE(eventually([&] { return room.expired(); }));
}

struct RoomTokensTest : RoomsTest {
    RoomTokensTest() { options.token_key = std::string(net::kLeastKeyBytes, 'k'); }
    std::string bearer(const char* room) const {
        const auto soon = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()) + 60s;
        return "Authorization: Bearer " + net::makeToken({net::Role::operator_, soon, "ann", room}, options.token_key) +
               "\r\n";
    }
    std::unique_ptr<WsClient> come(const char* path, const char* room) const {
        return std::make_unique<WsClient>(server->port(), 0, "Sec-WebSocket-Protocol: brume.v1\r\n" + bearer(room), "",
                                          path);
    }
};

TEST_F(RoomTokensTest, OpenWhatIsBelowTheRoomAndNothingElse) {
    const uint16_t port = serveTwo();
    for (const net::Route& route : net::allRoutes()) {
        if (!route.least) continue;
        const std::string path(route.path), in_room = "/r/lab" + path;
        const char* const method = route.takes("POST") ? "POST" : "GET";
        const HttpAnswer at_root = get(port, path, bearer("lab"), method);
        EXPECT_EQ(at_root.status, 403) << path;
        EXPECT_EQ(at_root.body, "this token is good in the room 'lab' alone: below /r/lab/\n") << path;
        if (route.of_server) continue;
        EXPECT_EQ(get(port, in_room, bearer("den"), method).status, 403) << in_room;
        if (path == "/stream.mjpg") continue; // a good one never ends
        for (const char* good : {"lab", ""}) {
            const int status = get(port, in_room, bearer(good), method).status;
            EXPECT_TRUE(status != 401 && status != 403) << in_room << " with a token of '" << good << "': " << status;
        }
    }
    EXPECT_EQ(get(port, "/r/lab/metrics", bearer("lab")).status, 200);
    EXPECT_EQ(get(port, "/r/lab/viewers", bearer("lab")).status, 200);
    EXPECT_EQ(get(port, "/rooms", bearer("")).status, 200);
}

// A session goes on with a newer token of its room, and of no other.
TEST_F(RoomTokensTest, OfAnotherRoomContinuesNoSession) {
    serveTwo();
    std::string key;
    {
        const auto lost = come("/r/lab/ws", "lab");
        ASSERT_EQ(lost->handshake.status, 101) << lost->handshake.body;
        lost->hello();
        const auto welcome = lost->next<wire::Welcome>();
        ASSERT_TRUE(welcome);
        key = welcome->parsed->as<wire::Welcome>()->resume()->str();
    }
    ASSERT_TRUE(eventually([&] { return lab_audience->size() == 0; }));
    EXPECT_EQ(come("/r/lab/ws", "den")->handshake.status, 403);
    EXPECT_EQ(come("/ws", "lab")->handshake.status, 403);
    const auto back = come("/r/lab/ws", "lab");
    ASSERT_EQ(back->handshake.status, 101);
    back->say([&](auto& b) { return wire::CreateHelloDirect(b, "test client", 640, 360, 1, 80, key.c_str()); });
    const auto welcome = back->next<wire::Welcome>();
    ASSERT_TRUE(welcome);
    EXPECT_TRUE(welcome->parsed->as<wire::Welcome>()->resumed());
}

} // namespace
} // namespace brume::test
