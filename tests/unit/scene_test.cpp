// Loading scenes: what is shipped, and what is taken over.
#include "common/scene.h"
#include "common/scene_limits.h"

#include <cctype>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "server/sim/simulation.h"
#include "tests/unit/scene_file.h"

namespace brume {
namespace {

const std::filesystem::path kScenes = "server/scenes"; // tests run in the repository's root

using test::errorOf, test::written;

TEST(Scene, TakesEveryValueOver) {
    const Scene scene = loadScene(written(R"(
name = "all"
[medium]
layout = "emitter"
count = 400
scale = [1, 2]
multiplier = 7
albedo = [0.1, 0.2, 0.3]
seed = 9007199254740992
[medium.emitter]
rate = 40
life = 10
wind = [1, 0, -1]
[simulation]
spring = 3
paused = true
[[light]]
type = "directional"
to_light = [0, 3, 4]
irradiance = [1, 2, 3]
rotate = -0.5
rotate_axis = [0, 0, -2]
[[fog]]
[[fog]]
extinction = 0.5
height = 2
lo = -1
radius = 3
phase = "double"
second_asymmetry = -0.25
emission = [1, 0.5, 0]
extinction_colour = [0.5, 0, 1]
[[plane]]
height = -1
[[box]]
yaw = 1
[[box]]
[[sphere]]
radius = 2
[sky]
ambient = [0, 0, 0.5]
[camera]
fov_y = 1
[render]
shadow_size = "auto"
shadow_slices = 9
shadow_error = 0.01
slabs = "auto"
method = "isv"
[render.isv]
quadrature = "transmittance"
steps = 3
[render.tiles]
quadrature = "hermite"
[render.grid]
spacing = "auto"
)"));
    EXPECT_EQ(scene.name, "all");
    EXPECT_EQ(scene.medium.layout, Layout::emitter);
    EXPECT_EQ(scene.medium.count, 400u);
    EXPECT_EQ(scene.medium.scale.hi, 2);
    EXPECT_EQ(scene.medium.multiplier.lo, 7);
    EXPECT_EQ(scene.medium.multiplier.hi, 7);
    EXPECT_EQ(scene.medium.albedo, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(scene.medium.seed, 9007199254740992u);
    EXPECT_EQ(scene.medium.emitter.wind, glm::vec3(1, 0, -1));
    EXPECT_EQ(scene.simulation.spring, 3);
    EXPECT_TRUE(scene.simulation.paused);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_LT(glm::distance(scene.lights[0].to_light, glm::vec3(0, 0.6f, 0.8f)), 1e-6f);
    EXPECT_EQ(scene.lights[0].rotate, -0.5f);
    EXPECT_EQ(scene.lights[0].rotate_axis, glm::vec3(0, 0, -1));
    ASSERT_EQ(scene.fogs.size(), 2u);
    EXPECT_EQ(scene.fogs[0].extinction, Fog().extinction);
    EXPECT_EQ(scene.fogs[1].extinction, 0.5f);
    EXPECT_EQ(scene.fogs[1].height, 2);
    EXPECT_EQ(scene.fogs[1].lo, -1);
    EXPECT_EQ(double(scene.fogs[1].hi), limits::kPlace.hi);
    EXPECT_EQ(scene.fogs[1].radius, 3);
    EXPECT_EQ(scene.fogs[1].phase, "double");
    EXPECT_EQ(scene.fogs[1].second_asymmetry, -0.25f);
    EXPECT_EQ(scene.fogs[1].emission, glm::vec3(1, 0.5f, 0));
    EXPECT_EQ(scene.fogs[0].extinction_colour, glm::vec3(1));
    EXPECT_EQ(scene.fogs[1].extinction_colour, glm::vec3(0.5f, 0, 1));
    EXPECT_EQ(scene.medium.extinction_colour, glm::vec3(1));
    EXPECT_EQ(scene.planes.at(0).height, -1);
    EXPECT_EQ(scene.boxes.size(), 2u);
    EXPECT_EQ(scene.spheres.at(0).radius, 2);
    EXPECT_EQ(scene.sky.ambient.z, 0.5f);
    EXPECT_EQ(scene.camera.fov_y, 1);
    EXPECT_EQ(scene.render.method, "isv");
    EXPECT_EQ(scene.render.isv.steps, 3u);
    EXPECT_EQ(scene.render.isv.quadrature, "transmittance");
    EXPECT_EQ(scene.render.tiles.quadrature, "hermite");
    EXPECT_EQ(scene.render.grid.spacing, kAuto);
    EXPECT_EQ(scene.render.shadow_size, kAuto);
    EXPECT_EQ(scene.render.slabs, kAuto);
    EXPECT_EQ(scene.render.shadow_slices, 9u);
    EXPECT_EQ(scene.render.shadow_error, 0.01f);
}

// A million metres away float32 has steps of 6 cm; these places are exact in double, and after subtraction in float.
TEST(Scene, PlacesCountFromTheOrigin) {
    const Scene scene = loadScene(written(R"(
origin = [1e6, -2e6, 3e6]
[medium]
layout = "emitter"
count = 4200
centre = [1000001.125, -2e6, 3e6]
[medium.emitter]
position = [1000000.0009765625, -1999998, 2999997]
[[plane]]
height = -2000000.25
[[box]]
centre = [1000001, -1999999, 3000000.5]
[[box]]
[[sphere]]
centre = [999999, -2e6, 3e6]
[camera]
position = [1000000, -2000000, 3000010]
target = [1000000, -1999999.75, 3e6]
)"));
    EXPECT_EQ(scene.origin, glm::dvec3(1e6, -2e6, 3e6));
    EXPECT_EQ(scene.medium.centre, glm::vec3(1.125f, 0, 0));
    EXPECT_EQ(scene.medium.emitter.position, glm::vec3(0.0009765625f, 2, -3));
    EXPECT_EQ(scene.planes.at(0).height, -0.25f);
    EXPECT_EQ(scene.boxes.at(0).centre, glm::vec3(1, 1, 0.5f));
    EXPECT_EQ(scene.boxes.at(1).centre, glm::vec3(0)) << "left out: the default, counted from the origin";
    EXPECT_EQ(scene.spheres.at(0).centre, glm::vec3(-1, 0, 0));
    EXPECT_EQ(scene.camera.position, glm::vec3(0, 0, 10));
    EXPECT_EQ(scene.camera.target, glm::vec3(0, 0.25f, 0));
    // What moves a file's points is a displacement: the origin is subtracted once, from the points.
    EXPECT_EQ(
        loadScene(written("origin = [1e6, 0, 0]\n[medium]\nlayout = \"file\"\nfile = \"a.ply\"\ncentre = [1, 2, 3]"))
            .medium.centre,
        glm::vec3(1, 2, 3));
}

TEST(Scene, AnEmptyFileIsTheDefaultScene) {
    const Scene scene = loadScene(written("", "empty.toml"));
    EXPECT_EQ(scene.name, "empty");
    EXPECT_EQ(scene.medium.count, 500u);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_NEAR(glm::length(scene.lights[0].to_light), 1, 1e-6f);
}

TEST(Scene, MayHaveNoParticles) {
    const Simulation simulation(loadScene(written("[medium]\nlayout = \"none\"\n[[fog]]")));
    EXPECT_EQ(simulation.liveCount(), 0u);
    EXPECT_EQ(simulation.now().lists.fogs.size(), 1u);
}

TEST(Scene, MayHaveNoLight) {
    EXPECT_TRUE(loadScene(written("light = []", "dark.toml")).lights.empty());
    const std::string off[] = {"light=[]"};
    EXPECT_TRUE(loadScene(written("[[light]]\nrotate = 1"), off).lights.empty());
}

TEST(Scene, OverridesReplaceTheFilesSettings) {
    const auto file = written("[medium]\ncount = 7\nextent = 3\n[[light]]\nrotate = 1");
    const std::string set[] = {"medium.count=9", "render.method=isv", "light.irradiance=[1, 2, 3]",
                               "sky.ambient=[0.5, 0.5, 0.5]"};
    const Scene scene = loadScene(file, set);
    EXPECT_EQ(scene.medium.count, 9u);
    EXPECT_EQ(scene.medium.extent, 3);
    EXPECT_EQ(scene.render.method, "isv");
    EXPECT_EQ(scene.lights.at(0).irradiance, glm::vec3(1, 2, 3));
    EXPECT_EQ(scene.lights.at(0).rotate, 1);
    EXPECT_EQ(scene.sky.ambient, glm::vec3(0.5f));
    for (const std::string wrong : {"medium.count", "=3", "medium.cuont=3", "medium.count=0", "medium.count=x",
                                    "medium=3", "shape=3", "light.rotate=1e9"}) {
        try {
            loadScene(file, {&wrong, 1});
            ADD_FAILURE() << wrong;
        } catch (const SceneError& error) {
            EXPECT_TRUE(std::string(error.what()).starts_with("--set ")) << error.what() << ": it is not the file's";
        }
    }
}

TEST(Scene, AParticleFileStandsBesideItsScene) {
    const auto file = written("[medium]\nlayout = \"file\"\nfile = \"points.ply\"");
    EXPECT_EQ(loadScene(file).medium.file, file.parent_path() / "points.ply");
}

TEST(Scene, WhatCannotBeReadSaysSo) {
    EXPECT_THROW(loadScene("no/such/file.toml"), SceneError);
    EXPECT_THROW(loadScene(testing::TempDir()), SceneError);
    EXPECT_NE(errorOf(std::string(2 << 20, '#')).find("larger than 1 MiB"), std::string::npos);
    EXPECT_NE(errorOf(std::string("name = \"\xff\xfe\"")).find("syntax"), std::string::npos);
}

// The parser recurses, and so does what it makes: 64 kB of dots ended the process.
TEST(Scene, WhatIsTooDeepIsRefusedInOneLine) {
    std::string dotted = "x", tables = "x = ", arrays = "x = ", both = "x = ";
    for (int i = 0; i < 32'000; ++i) dotted += ".a", tables += "{a = ", arrays += "[";
    std::string quoted = "x", literal = "x", equals = "x", comments = "x";
    for (int i = 0; i < 32'000; ++i)
        quoted += ".\"a\"", literal += ".''", equals += ".\"=\".a", comments += ".\"#\".'\"'";
    for (int i = 0; i < 200; ++i) both += "{a.a.a.a.a.a.a.a.a.a.a.a = ";
    for (const std::string& text :
         {quoted + " = 1", literal + " = 1", equals + " = 1", comments + " = 1",
          "a = \"\"\"\nb\\\"\"\"\"\"\"\n" + dotted + " = 1", dotted + " = 1", tables, arrays, both, "[" + dotted + "]",
          "[[" + dotted + "]]", "\n\n" + dotted, "# a.b\n\"x\" . 'y' " + dotted.substr(1) + " = 1"}) {
        const std::string why = errorOf(text);
        EXPECT_NE(why.find("syntax"), why.npos) << text.substr(0, 40) << ": " << why.substr(0, 200);
        EXPECT_LT(why.size(), 300u);
    }
    const std::vector<std::string> overrides{dotted + "=1"};
    EXPECT_THROW(loadScene(written(""), overrides), SceneError);
    EXPECT_EQ(errorOf("# 1.0 0.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 0.0 1.0 0.0 0.0 0.0 0.0 1.0 1.0 {{{{{{{{{{{{{{{{{{{{\n"
                      "name = \"1.2.3.4.5.6.7.8.9.10.11.12.13.14.15.16.17.{{{{{{{{{{{{{{{{{{\"\n"
                      "[camera]\ntarget = [0.5, 0.25, 0.125]\n"),
              "no error");
}

// To open a pipe waits for whoever writes there.
TEST(Scene, APipeIsNoFile) {
    const std::filesystem::path pipe = std::filesystem::path(testing::TempDir()) / "scene_test_pipe";
    std::filesystem::remove(pipe);
    ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_THROW(loadScene(pipe), SceneError);
    const auto points = [&](const char* layout, const char* file) {
        return written(std::string("[medium]\nlayout = \"") + layout + "\"\nfile = \"" + file + "\"\n");
    };
    EXPECT_THROW(Simulation(loadScene(points("file", "scene_test_pipe"))), SceneError);
    std::filesystem::rename(pipe, pipe.parent_path() / "scene_test_pipe7.ply");
    EXPECT_THROW(Simulation(loadScene(points("sequence", "scene_test_pipe#.ply"))), SceneError);
    EXPECT_THROW(loadScene(written("[[mesh]]\nfile = \"scene_test_pipe7.ply\"\n")), SceneError);
    std::filesystem::remove(pipe.parent_path() / "scene_test_pipe7.ply");
}

TEST(Scene, ARefusalIsOneLineWhateverItQuotes) {
    std::vector<std::string> refusals{errorOf("\"a\\nb\\u001b[2J\" = 1"),
                                      errorOf("[render]\ntone_map = \"a\\nb\\u001b[2J\""), errorOf("name = \x01")};
    const std::string override = "a\nb\x1b[2J";
    try {
        loadScene(written(""), {&override, 1});
    } catch (const SceneError& error) {
        refusals.emplace_back(error.what());
    }
    ASSERT_EQ(refusals.size(), 4u);
    for (const std::string& refusal : refusals)
        for (const char c : refusal) EXPECT_FALSE(std::iscntrl(static_cast<unsigned char>(c))) << refusal;
}

TEST(Scene, IsFoundByNameOrPath) {
    EXPECT_EQ(findScene("cloud", kScenes), kScenes / "cloud.toml");
    EXPECT_EQ(findScene("./mine", kScenes), "./mine");
    EXPECT_EQ(findScene("mine.toml", kScenes), "mine.toml");
    try {
        findScene("clod", kScenes);
        FAIL() << "found a scene that is not there";
    } catch (const SceneError& error) {
        EXPECT_NE(
            std::string(error.what())
                .find("cloud, cloud-5000, cloud-65535, courtyard, cube-and-sphere, cumulus, dusk, dusty-room, "
                      "flame, flythrough, glass, islands, lamp, morning, plume, props, smoke-spots, stage, street, "
                      "tetrahedra, tubes, tubes-union"),
            std::string::npos)
            << error.what();
    }
    EXPECT_THROW(findScene("cloud", "no/such/folder"), SceneError);
}

} // namespace
} // namespace brume
