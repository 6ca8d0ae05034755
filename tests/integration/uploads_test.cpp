// Point clouds that are uploaded while viewers look on, and particles that are taken out.
#include <csignal>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/ply/ply.h"
#include "server/sim/simulation.h"
#include "tests/integration/scenes_fixture.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"

namespace brume::test::uploads_test {
namespace {

const Pose kPose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);

class Uploads : public Scenes {};

// One tetrahedron with a corner at (3, 1, 0).
std::string tetrahedron(const std::string& last_corner = "3") {
    return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
           "property float sigma_t\nelement tetrahedron 1\nproperty list uchar int vertex_indices\nend_header\n"
           "3 1 0 2\n2 -1 -1 1\n4 -1 -1 1\n3 -1 1 1\n4 0 1 2 " +
           last_corner + "\n";
}

TEST_F(Uploads, AnUploadedCloudIsSeenAndListedAfterwards) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds()});
    HttpConnection upload(server.port());
    upload.send(postHead("/cloud?name=mine", points().size()) + "Expect: 100-continue\r\n\r\n");
    EXPECT_EQ(upload.readHead().status, 100) << "a client that asks is told to go on before it sends a large file";
    upload.send(points());
    const HttpReply reply = upload.readReply();
    EXPECT_EQ(reply.status, 200) << reply.body;
    Watcher a(server.endpoint());
    EXPECT_EQ(a.session.granted().scene, "mine");
    EXPECT_EQ(a.session.granted().target, glm::vec3(3, 0.5f, 0));
    a.look(lookAt(a.session.granted().position, a.session.granted().target, 0.8f));
    ASSERT_TRUE(watch({&a}, [&] { return !a.frames.empty(); }));
    EXPECT_GT(contrast(pictureOf(a.last())), 10);
    EXPECT_EQ(post(server.port(), "/scene?name=cloud").status, 200);
    EXPECT_EQ(post(server.port(), "/scene?name=mine").status, 200) << "it stays known by its name";
    EXPECT_EQ(post(server.port(), "/cloud?name=mine", points("1")).status, 200) << "and can be replaced";
}

TEST_F(Uploads, AnUploadWithTetrahedraIsShownAsThese) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds()});
    Watcher a(server.endpoint());
    const HttpReply broken = post(server.port(), "/cloud?name=mesh", tetrahedron("4"));
    EXPECT_EQ(broken.status, 422);
    EXPECT_EQ(broken.body, "mesh.ply: PLY: element tetrahedron, line 15: there is no vertex 4; expected 0 to 3\n");
    const HttpReply reply = post(server.port(), "/cloud?name=mesh", tetrahedron());
    ASSERT_EQ(reply.status, 200) << reply.body;
    a.look(kPose);
    ASSERT_TRUE(watch({&a}, [&] { return !a.frames.empty(); }));
    EXPECT_EQ(a.session.granted().scene, "mesh");
    EXPECT_EQ(loadScene(fs::path(clouds()) / "mesh.toml").medium.model, "tetrahedra");
}

// A file of points at those places, a line each.
std::string placed(const std::string& places) {
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(std::ranges::count(places, '\n')) +
           "\nproperty double x\nproperty double y\nproperty double z\nend_header\n" + places;
}
// 125 points of a cube, `step` from one to the next.
std::string cube(double step) {
    std::string places;
    for (int x = 0; x < 5; ++x)
        for (int y = 0; y < 5; ++y)
            for (int z = 0; z < 5; ++z) places += fmt::format("{} {} {}\n", x * step, y * step, z * step);
    return places;
}

// By how many levels of red the middle of a picture differs from its left side, where the sky is equally bright.
int middleAgainstSide(const client::Picture& picture) {
    const auto red = [&](int x) {
        return int(picture.rgb[3 * (size_t(picture.height / 2) * size_t(picture.width) + size_t(x))]);
    };
    return std::abs(red(picture.width / 2) - red(2));
}

// Wherever a cloud is and whatever its unit, it is in the middle of the picture, and the answer says what was done.
TEST_F(Uploads, AnUploadedCloudIsSeenWhereverItIs) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds()});
    const struct {
        std::string places, query, says;
    } all[]{
        {cube(1), "", "shown: 125 points in [0, 0, 0] to [4, 4, 4] m\n"},
        {cube(1) + "40000 0 0\n", "", "1 point is 40 km from the others and left out"},
        {"0 0 0\n1e-6 0 0\n0 1e-6 0\n0 0 4e-6\n", "", "shown 1e+06 times as large"},
        {"0 0 0\n100000 0 0\n0 100000 0\n0 0 400000\n", "", "shown 0.01 times as large"},
        {"700000 5300000 400\n700001 5300000 400\n700000 5300002 400\n700000 5300000 403\n", "&origin=auto",
         "origin is moved to the points: [700000, 5300000, 400]"},
        {cube(1000), "&unit=mm", "shown: 125 points in [0, 0, 0] to [4, 4, 4] m\n"},
        {"0 0 0\n1 0 0\n0 2 0\n0 0 3\n", "&up=z", "in [0, 0, -2] to [1, 3, 0] m"},
    };
    for (const auto& one : all) {
        const HttpReply reply = post(server.port(), "/cloud?name=mine" + one.query, placed(one.places));
        ASSERT_EQ(reply.status, 200) << reply.body;
        EXPECT_NE(reply.body.find(one.says), reply.body.npos) << reply.body << "\nnot: " << one.says;
        EXPECT_EQ(reply.body.find(clouds()), reply.body.npos) << "no folders of the server: " << reply.body;
        Watcher a(server.endpoint());
        a.look(lookAt(a.session.granted().position, a.session.granted().target, 0.8f));
        ASSERT_TRUE(watch({&a}, [&] { return !a.frames.empty(); }));
        EXPECT_GT(middleAgainstSide(pictureOf(a.last())), 6) << reply.body;
    }
}

// Their colours are seen as they are: light is in them.
TEST_F(Uploads, SplatsAreShownInAmbientLightAlone) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds()});
    std::string file = "ply\nformat ascii 1.0\nelement vertex 2\n";
    for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2"})
        file += std::string("property float ") + name + "\n";
    file += "end_header\n0 0 0 1.7 -1.7 -1.7 6 0 0 0\n0.1 0 0 1.7 -1.7 -1.7 6 0 0 0\n"; // red, and hardly seen through
    const HttpReply reply = post(server.port(), "/cloud?name=splats", file);
    ASSERT_EQ(reply.status, 200) << reply.body;
    EXPECT_NE(reply.body.find("in ambient light alone"), reply.body.npos) << reply.body;
    EXPECT_NE(get(server.port(), "/scene.toml").body.find("light = []"), std::string::npos);
    Watcher a(server.endpoint());
    a.look(lookAt(a.session.granted().position, a.session.granted().target, 0.8f));
    ASSERT_TRUE(watch({&a}, [&] { return !a.frames.empty(); }));
    const client::Picture picture = pictureOf(a.last());
    const uint8_t* middle =
        &picture.rgb[3 * (size_t(picture.height / 2) * size_t(picture.width) + size_t(picture.width / 2))];
    EXPECT_GT(middle[0], 200);
    EXPECT_LT(middle[1], 100);
}

// A block of 16 voxels a side, half a metre wide each.
std::string block(float extinction, const std::string& type = "float") {
    std::string file = "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: 16 16 16\nspacings: 0.5 0.5 0.5\n" +
                       "endian: little\nencoding: raw\n\n";
    for (int i = 0; i < 16 * 16 * 16; ++i) file.append(reinterpret_cast<const char*>(&extinction), sizeof extinction);
    return file;
}

TEST_F(Uploads, AVolumeIsSeenAndCanBeReplacedByPoints) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds(), "--paused"});
    EXPECT_NE(post(server.port(), "/cloud?name=block", block(1, "block")).body.find("type is \"block\""),
              std::string::npos);
    EXPECT_EQ(post(server.port(), "/cloud?name=block", block(0)).status, 422) << "nothing to see";
    const HttpReply reply = post(server.port(), "/cloud?name=block&up=z", block(3));
    ASSERT_EQ(reply.status, 200) << reply.body;
    EXPECT_NE(reply.body.find("16 x 16 x 16 voxels in ["), std::string::npos) << reply.body;
    const std::string scene = get(server.port(), "/scene.toml").body;
    EXPECT_NE(scene.find("layout = 'volume'"), std::string::npos) << scene;
    Watcher a(server.endpoint());
    a.look(lookAt(a.session.granted().position, a.session.granted().target, 0.8f));
    ASSERT_TRUE(watch({&a}, [&] { return !a.frames.empty(); }));
    const client::Picture picture = pictureOf(a.last());
    const auto at = [&](int x, int y) { return &picture.rgb[3 * (size_t(y) * size_t(picture.width) + size_t(x))]; };
    const uint8_t *middle = at(picture.width / 2, picture.height / 2), *corner = at(2, 2);
    EXPECT_GT(std::abs(middle[2] - corner[2]), 20) << "a white block before a blue sky";
    EXPECT_EQ(post(server.port(), "/cloud?name=block", points()).status, 200);
    EXPECT_FALSE(fs::exists(fs::path(clouds()) / "block.nrrd"));
    const HttpReply json = [&] {
        HttpConnection upload(server.port());
        const std::string file = block(3);
        upload.send(postHead("/cloud?name=block", file.size()) + "Accept: application/json\r\n\r\n" + file);
        return upload.readReply();
    }();
    EXPECT_EQ(nlohmann::json::parse(json.body)["voxels"], nlohmann::json::parse("[16, 16, 16]")) << json.body;
}

// What is taken out can be put in again: the same particles, to the bit.
TEST_F(Uploads, ParticlesAreTakenOutAndReadBack) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds(), "--paused"});
    const HttpReply out = get(server.port(), "/particles.ply");
    ASSERT_EQ(out.status, 200) << out.body.substr(0, 200);
    EXPECT_NE(out.headers.at("content-disposition").find("cloud-"), std::string::npos);
    Scene scene = loadScene("server/scenes/cloud.toml");
    const Simulation cloud(scene);
    const PointCloud read = parsePly(out.body, "out.ply", {}, {.ids = true});
    ASSERT_EQ(read.position.size(), cloud.liveCount());
    std::vector<gpu::Particle> particles(cloud.liveCount());
    cloud.write(particles);
    EXPECT_EQ(scene.medium.falloff, Medium().falloff);
    for (size_t i = 0; i < particles.size(); ++i) {
        EXPECT_EQ(read.position[i], particles[i].centre);
        EXPECT_EQ(read.scale[i], particles[i].scale);
        EXPECT_EQ(read.sigma_t[i], particles[i].sigma_t);
        EXPECT_EQ(read.albedo[i], particles[i].albedo);
        EXPECT_EQ(read.id[i], int64_t(i));
    }
    EXPECT_TRUE(read.notes.empty() && read.ignored.empty());
    ASSERT_EQ(post(server.port(), "/cloud?name=again", out.body).status, 200);
    const HttpReply again = get(server.port(), "/particles.ply");
    EXPECT_EQ(again.body.substr(again.body.find("element")), out.body.substr(out.body.find("element")));
    const fs::path none = write("none.toml", "[medium]\nlayout = \"none\"\n[[fog]]\n");
    RunningServer empty({"--ahead", "off", "--scene", none.string()});
    EXPECT_EQ(get(empty.port(), "/particles.ply").status, 404);
}

// Splats keep their axes, and what is taken out of them keeps them as well.
TEST_F(Uploads, SplatsAreEllipsoidsAndAreReadBack) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds(), "--paused"});
    std::string file = "ply\nformat ascii 1.0\nelement vertex 40\n";
    for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                             "rot_0", "rot_1", "rot_2", "rot_3"})
        file += "property float " + std::string(name) + "\n";
    file += "end_header\n";
    for (int i = 0; i < 40; ++i)
        file +=
            fmt::format("{} {} {} 1 0 -1 {} -1 -2 -3.5 {} {} 0.3 0.2\n", i % 4, i / 4 % 4, i / 16, 0.1 * i, i, 40 - i);
    ASSERT_EQ(post(server.port(), "/cloud?name=discs", file).status, 200);
    EXPECT_NE(get(server.port(), "/scene.toml").body.find("ellipsoids"), std::string::npos);
    const HttpReply out = get(server.port(), "/particles.ply");
    const PointCloud read = parsePly(out.body, "out.ply", {}, {.ids = true, .axes = true});
    const PointCloud given = parsePly(file, "discs.ply", {}, {.axes = true});
    ASSERT_EQ(read.axes.size(), 40u);
    for (size_t i = 0; i < 40; ++i) {
        EXPECT_EQ(read.axes[i].a, given.axes[i].a);
        EXPECT_EQ(read.axes[i].b, given.axes[i].b);
        EXPECT_EQ(read.axes[i].c, given.axes[i].c);
    }
    ASSERT_EQ(post(server.port(), "/cloud?name=again", out.body).status, 200);
    const HttpReply again = get(server.port(), "/particles.ply");
    EXPECT_EQ(again.body.substr(again.body.find("element")), out.body.substr(out.body.find("element")));
    Watcher a(server.endpoint());
    a.look(lookAt(a.session.granted().position, a.session.granted().target, 0.8f));
    ASSERT_TRUE(watch({&a}, [&] { return !a.frames.empty(); }));
}

TEST_F(Uploads, TheAnswerToAnUploadIsForProgramsToo) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds()});
    const std::string file = placed("0 0 0\n1 0 0\n0 2 0\nnan 0 3\n");
    HttpConnection upload(server.port());
    upload.send(postHead("/cloud?name=mine", file.size()) + "Accept: application/json\r\n\r\n" + file);
    const HttpReply reply = upload.readReply();
    ASSERT_EQ(reply.status, 200) << reply.body;
    EXPECT_EQ(reply.headers.at("content-type"), "application/json");
    const nlohmann::json answer = nlohmann::json::parse(reply.body);
    EXPECT_EQ(answer["scene"], "mine");
    EXPECT_EQ(answer["points"], 3);
    EXPECT_EQ(answer["box"], nlohmann::json::parse("[[0, 0, 0], [1, 2, 0]]"));
    EXPECT_NE(answer["notes"].dump().find("dropped 1 of 4 points"), std::string::npos) << reply.body;
    for (const char* query : {"unit=mile", "up=w", "origin=1,2", "far_points=some", "size=3"}) {
        const HttpReply wrong = post(server.port(), std::string("/cloud?") + query, file);
        EXPECT_EQ(wrong.status, 400) << query;
        EXPECT_NE(wrong.body.find("/cloud?"), std::string::npos) << wrong.body;
    }
}

TEST_F(Uploads, AFileThatIsTooLargeIsRefusedBeforeItIsRead) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds(), "--max-upload", "1"});
    HttpConnection connection(server.port());
    connection.send(postHead("/cloud", (1 << 20) + 1) + "\r\n");
    const HttpReply reply = connection.readReply();
    EXPECT_EQ(reply.status, 413);
    EXPECT_EQ(reply.body, "the file is over 1 MiB: --max-upload\n");
    EXPECT_EQ(post(server.port(), "/cloud?name=small", points()).status, 200);
}

TEST_F(Uploads, AnUploadComesInAnyWayOrIsToldHow) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds(), "--max-upload", "1"});
    const auto chunked = [&](const std::string& name, const std::string& body) {
        HttpConnection connection(server.port());
        connection.send("POST /cloud?name=" + name +
                        " HTTP/1.1\r\nHost: 127.0.0.1\r\nTransfer-Encoding: chunked\r\n\r\n" + body);
        return connection.readReply();
    };
    const auto chunk = [](const std::string& bytes) {
        char size[16];
        std::snprintf(size, sizeof size, "%zx\r\n", bytes.size());
        return size + bytes + "\r\n";
    };
    const std::string half = points().substr(0, 50);
    const HttpReply taken = chunked("pieces", chunk(half) + chunk(points().substr(50)) + "0\r\n\r\n");
    EXPECT_EQ(taken.status, 200) << taken.body;
    const std::string piece = chunk(std::string(1 << 18, ' '));
    const HttpReply large = chunked("large", piece + piece + piece + piece + piece);
    EXPECT_EQ(large.status, 413);
    EXPECT_EQ(large.body, "the file is over 1 MiB: --max-upload\n");
    HttpConnection form(server.port());
    form.send(postHead("/cloud?name=form", 3) + "Content-Type: multipart/form-data; boundary=a\r\n\r\n--a");
    const HttpReply refused = form.readReply();
    EXPECT_EQ(refused.status, 415);
    EXPECT_NE(refused.body.find("--data-binary"), refused.body.npos) << refused.body;
}

TEST_F(Uploads, AnUploadThatDripsKeepsNobodyOut) {
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds()});
    HttpConnection slow(server.port());
    slow.send(postHead("/cloud?name=slow", points().size()) + "\r\n" + points().substr(0, 10));
    EXPECT_EQ(post(server.port(), "/cloud?name=mine", points()).status, 200);
}

// A file of so many tetrahedra apart from each other, which takes seconds to load.
std::string tetrahedra(int count) {
    std::string vertices, cells;
    for (int i = 0; i < count; ++i) {
        for (int corner = 0; corner < 4; ++corner) {
            const int x = i % 1000 * 3 + (corner == 3), z = i / 1000 * 3 + (corner == 2);
            vertices += std::to_string(x) + (corner == 1 ? " 1 " : " 0 ") + std::to_string(z) + " 1\n";
        }
        cells += "4";
        for (int corner = 0; corner < 4; ++corner) cells += ' ' + std::to_string(4 * i + corner);
        cells += '\n';
    }
    return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(4 * count) +
           "\nproperty float x\nproperty float y\nproperty float z\nproperty float sigma_t\nelement tetrahedron " +
           std::to_string(count) + "\nproperty list uchar int vertex_indices\nend_header\n" + vertices + cells;
}

constexpr milliseconds kSoon{kSanitized ? 20'000 : 5000}; // loading takes longer, however slow the machine is

TEST_F(Uploads, SigtermEndsALoadAtTheStart) {
    write("many.ply", tetrahedra(120'000));
    const fs::path file =
        write("many.toml", "[medium]\nmodel = \"tetrahedra\"\nlayout = \"file\"\nfile = \"many.ply\"\n");
    const auto server = startServer({"--scene", file.string(), "--port", "0", "--ahead", "off"});
    const auto used = [&] { // processor time, in clock ticks
        std::ifstream in("/proc/" + std::to_string(server->id()) + "/stat");
        std::string word;
        for (int field = 0; field < 14; ++field) in >> word;
        return std::atoi(word.c_str());
    };
    while (used() < 50) std::this_thread::sleep_for(milliseconds(10));
    server->signal(SIGTERM);
    EXPECT_EQ(server->exitCode(kSoon), 0) << server->err();
    EXPECT_NE(server->err().find("stopped"), std::string::npos) << server->err();
}

TEST_F(Uploads, SigtermEndsALoadWhileViewersLookOn) {
    const std::string points = tetrahedra(120'000);
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds()});
    Watcher a(server.endpoint());
    a.look(kPose);
    ASSERT_TRUE(watch({&a}, [&] { return !a.frames.empty(); }));
    HttpConnection upload(server.port());
    upload.send(postHead("/cloud?name=many", points.size()) + "\r\n" + points);
    const auto isComing = [&] {
        std::error_code none; // there is no such folder yet
        return std::ranges::any_of(fs::recursive_directory_iterator(fs::path(clouds()) / "incoming", none),
                                   [](const auto& entry) { return entry.path().filename() == "many.ply"; });
    };
    ASSERT_TRUE(watch({&a}, isComing));
    server.process().signal(SIGTERM);
    EXPECT_TRUE(watch(
        {&a}, [&] { return a.goodbye.has_value(); }, kSoon));
    EXPECT_EQ(server.process().exitCode(kSoon), 0) << server.process().err();
}

// So many points in a row.
std::string row(int count) {
    std::string all = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
                      "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    for (int i = 0; i < count; ++i) all += std::to_string(i) + " 0 0\n";
    return all;
}

TEST_F(Uploads, AnUploadThatIsRefusedReplacesNothing) {
    const fs::path small = write("small.toml", "[medium]\ncount = 100\n");
    RunningServer server({"--ahead", "off", "--cloud-dir", clouds(), "--memory", "4", "--scene", small.string()});
    ASSERT_EQ(post(server.port(), "/cloud?name=mine", points()).status, 200);
    const HttpReply large = post(server.port(), "/cloud?name=mine", row(20'000));
    EXPECT_EQ(large.status, 422);
    EXPECT_NE(large.body.find("20000 particles take "), large.body.npos) << large.body;
    const HttpReply again = post(server.port(), "/scene?name=mine");
    EXPECT_EQ(again.status, 200) << again.body;
    EXPECT_EQ(metric(server.port(), "brume_particles"), 3);
}

} // namespace
} // namespace brume::test::uploads_test
