// Everything that may be set on a running server is set, one after the other: nobody who looks on waits for a compiler.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/integration/http.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/layer.h"
#include "tests/other_values.h"

namespace brume::test::live_settings_test {
namespace {

using Clock = std::chrono::steady_clock;

const Pose kPose = lookAt({0, 2, 12}, {0, 0, 0}, 0.8f);
const client::Wishes kTiny{.width = 64, .height = 36, .views = 1, .quality = 80};
constexpr milliseconds kCompiled{240'000}; // longer than anything takes to compile
const std::string kCube = "count = 50\nextent = 4\nscale = 2\n";
constexpr size_t kFramesEach = 4; // of a setting

void set(Watcher& watcher, std::string_view path, const SettingValue& value) {
    watcher.session.sendCommand<wire::Set>([&](auto& b) {
        const std::string name(path);
        std::vector<flatbuffers::Offset<wire::Change>> changes;
        if (const auto* text = std::get_if<std::string>(&value)) {
            changes = {wire::CreateChangeDirect(b, name.c_str(), {}, nullptr, text->c_str())};
        } else if (const auto* v = std::get_if<glm::vec3>(&value)) {
            const wire::Vec3 vector(v->x, v->y, v->z);
            changes = {wire::CreateChangeDirect(b, name.c_str(), {}, &vector)};
        } else {
            const double number = std::holds_alternative<bool>(value)    ? double(std::get<bool>(value))
                                  : std::holds_alternative<float>(value) ? double(std::get<float>(value))
                                                                         : double(std::get<uint32_t>(value));
            changes = {wire::CreateChangeDirect(b, name.c_str(), number)};
        }
        return wire::CreateSetDirect(b, &changes);
    });
}

// The tables whose settings are walked with a method, after one of its settings was given a value.
struct Walk {
    const char *method, *path, *value;
    std::vector<std::string_view> tables;
};
const std::vector<Walk> kOfASum{{"slabs", "render.scattering", "single", {"render", "medium", "light"}},
                                {"slabs", "render.scattering", "octaves", {}},
                                {"grid", "render.scattering", "propagation", {"render.propagation", "render.grid"}},
                                {"tiles", "render.scattering", "single", {"render.tiles"}},
                                {"isv", "render.isv.quadrature", "simpson", {"render.isv"}},
                                {"sphere", "render.scattering", "single", {}},
                                {"froxels", "render.froxels.shadows", "ray", {"render.froxels"}},
                                {"froxels", "render.froxels.shadows", "hybrid", {"render.shadow_grid"}},
                                {"lit", "render.scattering", "single", {}},
                                {"gradients", "render.scattering", "single", {"render.radiance"}},
                                {"march", "render.scattering", "single", {"render.march"}}};
const std::vector<Walk> kOfAUnion{{"sprites", "render.sprites.light", "path", {"render.sprites", "render.path"}},
                                  {"tiles", "render.tiles.light", "path", {"render.tiles"}}};
const std::vector<Walk> kOfTetrahedra{{"tetrahedra", "render.scattering", "single", {"render.tetrahedra"}}};

TEST(LiveSettings, AreAllInATableThatIsWalked) {
    std::set<std::string_view> tables{"simulation"}; // no picture's
    for (const auto* all : {&kOfASum, &kOfAUnion, &kOfTetrahedra})
        for (const Walk& walk : *all) tables.insert(walk.tables.begin(), walk.tables.end());
    for (const SceneSetting* setting : liveSettings()) EXPECT_TRUE(tables.contains(setting->table())) << setting->path;
}

// A server on an empty cache of shaders, one who sets and one who looks on.
class AllLiveSettings : public testing::Test {
protected:
    const std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("brume-settings-" + std::to_string(getpid()));
    std::unique_ptr<RunningServer> server_;
    std::unique_ptr<Watcher> operator_, viewer_;
    double longest_ms_ = 0; // between two frames of the viewer
    std::string longest_at_;

    void SetUp() override {
        if (!whole()) GTEST_SKIP() << "it compiles all shaders anew, which takes minutes";
    }
    void start(const std::string& medium, const char* method) {
        std::filesystem::create_directories(folder_ / "cache");
        const std::string scene = (folder_ / "small.toml").string();
        std::ofstream(scene) << "[medium]\n"
                             << medium << "[[box]]\ncentre = [0, 3, 0]\nsize = [2, 0.5, 2]\n[[plane]]\nheight = -3\n"
                             << "[render]\nmethod = \"" << method << "\"\n";
        server_ = std::make_unique<RunningServer>(
            std::vector<std::string>{"--ahead", "background", "--scene", scene, "--measure-error", "0", "--log-level",
                                     "debug", "--frame-budget", "5000"},
            std::vector<std::string>{"MESA_SHADER_CACHE_DIR=" + (folder_ / "cache").string()});
        operator_ = std::make_unique<Watcher>(server_->endpoint(), kTiny);
        operator_->session.sendPose(kPose, 0, 0, true);
        viewer_ = std::make_unique<Watcher>(server_->endpoint(), kTiny);
    }
    void TearDown() override {
        viewer_.reset(), operator_.reset(), server_.reset();
        std::filesystem::remove_all(folder_);
    }

    // Looks on until the viewer has so many more frames, and it is as wanted.
    void lookOn(
        const std::string& what, size_t frames, const std::function<bool()>& wanted = [] { return true; }) {
        Clock::time_point last = Clock::now();
        float x = 0;
        const auto look = [&] {
            Pose pose = kPose;
            pose.position.x = x += 0.1f; // a camera at rest gets no frames
            viewer_->look(pose);
        };
        viewer_->frames.clear();
        look();
        const auto enough = [&] {
            if (viewer_->frames.empty()) return false;
            const double ms = std::chrono::duration<double, std::milli>(Clock::now() - last).count();
            if (ms > longest_ms_) longest_ms_ = ms, longest_at_ = what;
            last = Clock::now();
            frames -= std::min(frames, viewer_->frames.size());
            viewer_->frames.clear();
            look();
            return frames == 0 && wanted();
        };
        ASSERT_TRUE(watch({viewer_.get(), operator_.get()}, enough, kCompiled))
            << what << " asked for, drawn with " << viewer_->method << '\n'
            << server_->process().err();
    }
    double waited() const { return metric(server_->port(), "brume_pipelines_waited_total").value_or(-1); }

    // Looks on until a snapshot is there: with shaders for the settings as they are now.
    void lookOnUntilCompiled(const std::string& what) {
        auto snapshot = std::async(std::launch::async, [&] {
            while (get(server_->port(), "/snapshot.jpg?w=64&h=36").status == 503) {
            } // it waits in there
        });
        lookOn(what, kFramesEach,
               [&] { return snapshot.wait_for(std::chrono::seconds(0)) == std::future_status::ready; });
        lookOn(what, kFramesEach);
        ASSERT_EQ(waited(), 0) << what << '\n' << server_->process().err();
    }

    // From the defaults of all settings and back to them.
    void walkAll(const std::vector<Walk>& walks) {
        for (const Walk& walk : walks) {
            const std::string method = walk.method;
            set(*operator_, "render.method", method);
            set(*operator_, walk.path, std::string(walk.value));
            ASSERT_NO_FATAL_FAILURE(lookOn(method, kFramesEach, [&] { return viewer_->method == method; }));
            for (const SceneSetting* setting : liveSettings()) {
                if (setting->path == "render.method" ||
                    std::ranges::find(walk.tables, setting->table()) == walk.tables.end())
                    continue;
                const SettingValue before =
                    setting->path == walk.path ? SettingValue(std::string(walk.value)) : defaultOf(*setting);
                for (const SettingValue& value : otherValues(*setting, before)) {
                    if (value == SettingValue(std::string("files"))) continue; // the scene has none
                    set(*operator_, setting->path, value);
                    ASSERT_NO_FATAL_FAILURE(lookOnUntilCompiled(fmt::format("{}: {}", method, setting->path)));
                }
                set(*operator_, setting->path, before);
            }
            set(*operator_, walk.path, defaultOf(*liveSetting(walk.path)));
        }
    }

    // First what is compiled meanwhile. Then all is.
    void walkTwice(const std::vector<Walk>& walks) {
        ASSERT_NO_FATAL_FAILURE(walkAll(walks));
        std::printf("longest time without a frame: %.0f ms, %s\n", longest_ms_, longest_at_.c_str());
        longest_ms_ = 0;
        ASSERT_NO_FATAL_FAILURE(walkAll(walks));
        std::printf("with all shaders compiled: %.0f ms, %s\n", longest_ms_, longest_at_.c_str());
        if (std::getenv("BRUME_IDLE_MACHINE")) {
            EXPECT_LE(longest_ms_, 100) << longest_at_;
        }
    }
};

TEST_F(AllLiveSettings, MakeNobodyWaitForACompiler) {
    start(kCube, "slabs");
    walkTwice(kOfASum);
}

TEST_F(AllLiveSettings, OfAUnionMakeNobodyWaitForACompiler) {
    start(kCube + "model = \"union\"\n", "sprites");
    walkTwice(kOfAUnion);
}

TEST_F(AllLiveSettings, OfTetrahedraMakeNobodyWaitForACompiler) {
    start("model = \"tetrahedra\"\nlayout = \"file\"\nfile = \"" +
              std::filesystem::absolute("server/scenes/tetrahedra.ply").string() + "\"\n",
          "tetrahedra");
    walkTwice(kOfTetrahedra);
}

} // namespace
} // namespace brume::test::live_settings_test
