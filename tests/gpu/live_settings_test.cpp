// What is compiled ahead is enough: settings whose shaders have one number (WayShaders) are drawn with the same
// pipelines, for every method and every setting that changes while a server runs. A driver compiles none while viewers
// wait.
#include <set>

#include <fmt/format.h>

#include "server/compile/compiled_ways.h"
#include "server/gpu/pipeline_cache.h"
#include "tests/gpu/tetrahedra_mesh.h"
#include "tests/layer.h"
#include "tests/other_values.h"

namespace brume::test::live_settings_test {
namespace {

constexpr uint32_t kWidth = 64, kHeight = 36;

class LiveSettingsTest : public GpuTest {
protected:
    // Of each kind of medium, with objects whose shadows fall on it.
    static Scene sceneFor(const MethodPlan& method) {
        Scene scene = sceneOf(randomPoints(20, 5, 1.6f, 0.35f), 1.6f);
        if (method.draws(kTetrahedraMedium)) {
            const Mesh mesh = lattice(2, 4, 0.1f, [](glm::vec3) { return 0.3f; });
            scene = sceneOf(mesh.points, 1, mesh.cells);
        } else if (!method.draws(kSumMedium)) {
            scene.medium.model = kUnionMedium;
        }
        scene.simulation.paused = true;
        scene.boxes = {{.centre = {0, 3, 0}, .size = {2, 0.5f, 2}}};
        scene.planes = {{.height = -3}};
        scene.render.method = method.name();
        scene.render.shadow_size = 32, scene.render.shadow_slices = 17;
        if (method.hasRays()) scene.render.rate = 4, scene.render.slabs = 16, scene.render.grid.spacing = 0.7f;
        return scene;
    }
};

// Pipelines that were made for other ways.
class Drawn {
public:
    Drawn(const gpu::Device& device, const Scene& scene)
        : listener_(device.pipelines(), [this](const std::string& text) { made_.insert(text); }), simulation_(scene),
          renderer_(device, scene, simulation_.capacity()), submission_(device, "settings") {}

    // Those that a picture makes now, and that none made before; an eye with a picture before it, and one without.
    std::set<std::string> with(const RenderSettings& settings, const SceneFeatures* drawn = nullptr) {
        made_.clear();
        if (drawn) renderer_.drawOnly(*drawn);
        EyeRequest eyes[2];
        for (EyeRequest& eye : eyes) eye = {lookAt({0, 2, 12}, {0, 0, 0}, 0.8f), kWidth, kHeight};
        eyes[1].history = 1;
        renderer_.submit(submission_, simulation_, eyes, &settings, full);
        waitFor(submission_.commands);
        for (const std::string& text : known_) made_.erase(text);
        known_.insert(made_.begin(), made_.end());
        return made_;
    }
    void step(CommandBody body) {
        const Command command{1, 1, std::move(body)};
        simulation_.step({&command, 1});
        for (const RefusedCommand& refused : simulation_.refused()) ADD_FAILURE() << refused.why;
    }
    const SceneNow& now() const { return simulation_.now(); }

    bool full = false;

private:
    std::set<std::string> made_, known_;
    gpu::PipelineListener listener_;
    Simulation simulation_;
    Renderer renderer_;
    Submission submission_;
};

std::string listed(const std::set<std::string>& texts) {
    std::string all;
    for (const std::string& text : texts) all += "\n  " + text;
    return all;
}

TEST_F(LiveSettingsTest, OfOneNumberOfShadersNeedTheSamePipelines) {
    for (const MethodPlan* method : methodPlans()) {
        const std::string_view name = method->name();
        if (!whole() && name != "slabs" && name != "froxels") continue;
        const Scene scene = sceneFor(*method);
        Drawn drawn(device(), scene);
        std::set<WayShaders> compiled;
        size_t tried = 0;
        const auto look = [&](const RenderSettings& settings, const std::string& what) {
            if (!checkSettings(settings).empty() || !scatteringRefusal(*method, settings).empty()) return;
            if (settings.sprites.maps == "files") return; // there are none
            const bool is_new = compiled.insert(shadersOf(settings, false)).second;
            const std::set<std::string> made = drawn.with(settings);
            EXPECT_TRUE(is_new || made.empty()) << method->name() << ", " << what << listed(made);
            ++tried;
        };
        for (const char* scattering : {"single", "octaves", "propagation"}) {
            if (!whole() && scattering != std::string_view("single")) continue;
            RenderSettings base = scene.render;
            base.scattering = scattering;
            look(base, scattering);
            for (const SceneSetting* setting : liveSettings()) {
                if (setting->table().substr(0, 6) != "render" || setting->path == "render.method") continue;
                if (setting->path == "render.scattering") continue;
                for (const SettingValue& value : otherValues(*setting, valueOf(*setting, {.render = &base}))) {
                    RenderSettings settings = base;
                    apply({setting->path, value}, {.render = &settings});
                    look(settings, fmt::format("{} {}", scattering, setting->path));
                }
            }
        }
        EXPECT_GT(tried, whole() ? 40u : 14u) << method->name();
        RecordProperty(method->name(), int(compiled.size()));
    }
}

// Those of the medium and of the light. What other shaders would draw is left out until these are compiled.
TEST_F(LiveSettingsTest, OfMediumAndLightNeedNoOtherPipelines) {
    for (const char* name : {"slabs", "grid", "tiles", "isv", "froxels", "gradients", "march"}) {
        if (!whole() && name != std::string_view("slabs")) continue;
        const MethodPlan& method = *planOf(name);
        Scene scene = sceneFor(method);
        if (method.drawsMultiple()) scene.render.scattering = "octaves";
        if (scene.render.method == "froxels") scene.render.froxels.shadows = "hybrid";
        for (const bool sun : {true, false}) {
            if (!sun) scene.lights.clear();
            Drawn drawn(device(), scene);
            const SceneFeatures features = featuresOf(drawn.now());
            drawn.with(scene.render, &features);
            drawn.full = true; // as where colours have hues of their own
            drawn.with(scene.render, &features);
            for (const SceneSetting* setting : liveSettings()) {
                if (setting->table() != "medium" && setting->table() != "light") continue;
                SceneNow before = drawn.now();
                for (const SettingValue& value : otherValues(*setting, valueOf(*setting, partsOf(before)))) {
                    drawn.step(Set{Change(setting->path, value)});
                    drawn.full = false;
                    const std::set<std::string> made = drawn.with(scene.render, &features);
                    EXPECT_TRUE(made.empty()) << name << ", " << setting->path << listed(made);
                }
                drawn.step(Set{Change(setting->path, valueOf(*setting, partsOf(before)))});
            }
        }
    }
}

} // namespace
} // namespace brume::test::live_settings_test
