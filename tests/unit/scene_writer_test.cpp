// What was tuned can be saved as a file, and loads as the same scene.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "common/scene_text.h"
#include "common/settings.h"

namespace brume::scene_writer_test {
namespace {

const std::filesystem::path kScenes = "server/scenes"; // tests run in the repository's root

// Numbers of a setting, and its text.
struct Flat {
    std::vector<double> numbers;
    std::string text;
};
struct Flatten {
    Flat operator()(const bool* v) const { return {{double(*v)}, {}}; }
    Flat operator()(const float* v) const { return {{double(*v)}, {}}; }
    Flat operator()(const uint32_t* v) const { return {{double(*v)}, {}}; }
    Flat operator()(const uint64_t* v) const { return {{}, std::to_string(*v)}; }
    Flat operator()(const glm::vec3* v) const { return {{double(v->x), double(v->y), double(v->z)}, {}}; }
    Flat operator()(const glm::dvec3* v) const { return {{v->x, v->y, v->z}, {}}; }
    Flat operator()(const Range* v) const { return {{double(v->lo), double(v->hi)}, {}}; }
    Flat operator()(const std::string* v) const { return {{}, *v}; }
    Flat operator()(const Layout* v) const { return {{double(*v)}, {}}; }
    Flat operator()(const std::filesystem::path* v) const { return {{}, v->filename().string()}; }
};

// Compares all settings of the tables whose structs are there.
void expectSame(const SceneParts& a, const SceneParts& b, std::string_view top) {
    for (const SceneSetting& setting : sceneSettings()) {
        if (!setting.table().starts_with(top) || (top.empty() && !setting.table().empty())) continue;
        const Flat left = std::visit(Flatten{}, setting.member(a)), right = std::visit(Flatten{}, setting.member(b));
        EXPECT_EQ(left.text, right.text) << setting.path;
        ASSERT_EQ(left.numbers.size(), right.numbers.size()) << setting.path;
        const double rounding = setting.form == Form::direction ? 2e-7 : 0; // they are made unit again
        for (size_t i = 0; i < left.numbers.size(); ++i)
            EXPECT_NEAR(left.numbers[i], right.numbers[i], rounding) << setting.path;
    }
}

template <class T>
void expectSame(std::vector<T>& a, std::vector<T>& b, T* SceneParts::*part, std::string_view name) {
    ASSERT_EQ(a.size(), b.size()) << name;
    for (size_t i = 0; i < a.size(); ++i) {
        SceneParts left, right;
        left.*part = &a[i];
        right.*part = &b[i];
        expectSame(left, right, name);
    }
}

void expectSame(Scene a, Scene b) {
    expectSame({.scene = &a}, {.scene = &b}, "");
    expectSame(a.lights, b.lights, &SceneParts::light, "light");
    expectSame({.medium = &a.medium}, {.medium = &b.medium}, "medium");
    EXPECT_EQ(a.medium.scale_by_spacing, b.medium.scale_by_spacing);
    expectSame(a.fogs, b.fogs, &SceneParts::fog, "fog");
    expectSame({.simulation = &a.simulation}, {.simulation = &b.simulation}, "simulation");
    expectSame(a.planes, b.planes, &SceneParts::plane, "plane");
    expectSame(a.boxes, b.boxes, &SceneParts::box, "box");
    expectSame(a.spheres, b.spheres, &SceneParts::sphere, "sphere");
    expectSame(a.meshes, b.meshes, &SceneParts::mesh, "mesh");
    expectSame({.objects = &a.objects}, {.objects = &b.objects}, "objects");
    expectSame({.sky = &a.sky}, {.sky = &b.sky}, "sky");
    CameraKey no_key;
    expectSame({.camera = &a.camera, .key = &no_key}, {.camera = &b.camera, .key = &no_key}, "camera");
    expectSame(a.camera_keys, b.camera_keys, &SceneParts::key, "camera.key");
    expectSame({.render = &a.render}, {.render = &b.render}, "render");
}

// Beside the shipped scenes, where files of meshes are.
Scene again(const Scene& scene) { return sceneOf(sceneToml(scene), kScenes / "else.toml"); }

TEST(SceneWriter, EveryShippedSceneLoadsAsTheSame) {
    for (const auto& entry : std::filesystem::directory_iterator(kScenes)) {
        if (entry.path().extension() != ".toml") continue;
        SCOPED_TRACE(entry.path().string());
        const Scene scene = loadScene(entry.path());
        expectSame(scene, again(scene));
    }
}

TEST(SceneWriter, OnlyWhatDiffersFromTheDefaultsIsWritten) {
    Scene scene;
    scene.name = "plain";
    scene.lights.emplace_back();
    EXPECT_EQ(sceneToml(scene), "name = 'plain'\n\n[[light]]\n");
    scene.medium.falloff = 2.5f;
    EXPECT_EQ(sceneToml(scene), "name = 'plain'\n\n[[light]]\n\n[medium]\nfalloff = 2.5\n");
}

// As of a server whose settings nobody has changed: it saves what its settings have now.
TEST(SceneWriter, DefaultsThatWereSetLoadAsTheSame) {
    Scene scene;
    scene.name = "plain";
    scene.lights.emplace_back();
    const SceneParts parts{.medium = &scene.medium,
                           .simulation = &scene.simulation,
                           .light = &scene.lights[0],
                           .sky = &scene.sky,
                           .render = &scene.render};
    for (const SceneSetting* setting : liveSettings()) apply({setting->path, defaultOf(*setting)}, parts);
    EXPECT_EQ(sceneToml(scene), "name = 'plain'\n\n[[light]]\n");
    expectSame(sceneOf("name = 'plain'\n", kScenes / "else.toml"), again(scene));
}

TEST(SceneWriter, ASceneWithoutLightsStaysDark) {
    Scene scene;
    scene.name = "dark";
    EXPECT_TRUE(again(scene).lights.empty());
}

// Each kind of value away from its default, far from zero, with a name that needs quotes.
TEST(SceneWriter, AllKindsOfValuesSurvive) {
    const std::string text = R"(
name = "a \"name\", é \\ and 'more'"
origin = [1000000.25, -3.0, 77000.125]
[[light]]
to_light = [0.1, 0.7, -0.3]
irradiance = [1.1, 2.2, 3.3]
rotate = 0.123456789
[medium]
layout = "emitter"
count = 5000
centre = [1000003.1, -2.7, 77000.9]
scale = [0.3333333, 1.7]
seed = 9007199254740991
[medium.emitter]
position = [1000000.5, -2.9, 77001.3]
wind = [0.1, 0.2, 0.3]
[simulation]
paused = true
[[fog]]
[[fog]]
height = 1.25
hi = 4.5
centre = [1000000.5, -2.5, 77000.5]
radius = 2.25
phase = "droplets"
[[plane]]
height = -3.7
structure = 0.3
structure_size = 12.5
[[box]]
yaw = 0.3
[[box]]
centre = [1000001.0, -2.0, 77000.0]
[render]
method = "slabs"
rate = 4
shared_order = false
[render.isv]
quadrature = "transmittance"
steps = 3
[render.grid]
spacing = 0.3
)";
    const Scene scene = sceneOf(text, "a/b.toml");
    EXPECT_EQ(scene.boxes.size(), 2u);
    expectSame(scene, again(scene));
}

TEST(SceneWriter, ACloudKeepsWhatItsFileSays) {
    for (const char* scale : {"", "scale = 6\n", "scale = [0.1, 0.1]\n"}) {
        const Scene scene = sceneOf("origin = [100, 0, 0]\n[medium]\nlayout = \"file\"\nfile = \"cloud.ply\"\n"
                                    "centre = [1, 2, 3]\n" +
                                        std::string(scale),
                                    "a/b.toml");
        expectSame(scene, again(scene));
        EXPECT_EQ(again(scene).medium.file, kScenes / "cloud.ply");
    }
}

TEST(SceneWriter, MediaFromElsewhereKeepTheirKeys) {
    for (const char* medium :
         {"layout = \"sequence\"\nfile = \"smoke-####.ply\"\nrate = 12.5\nloop = false\nscale = 6\n",
          "layout = \"sequence\"\nfile = \"smoke-####.ply\"\n", "layout = \"live\"\ncount = 77\n"}) {
        const Scene scene =
            sceneOf("origin = [100, 0, 0]\n[medium]\ncentre = [1, 2, 3]\n" + std::string(medium), "a/b.toml");
        expectSame(scene, again(scene));
    }
}

} // namespace
} // namespace brume::scene_writer_test
