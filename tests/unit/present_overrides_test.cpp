// A process that compiles shaders has the present scene: every setting that shaders may depend on.
#include "server/loop/present_overrides.h"

#include <gtest/gtest.h>

#include "common/scene_text.h"
#include "server/compile/compiled_ways.h"
#include "tests/other_values.h"

namespace brume::present_overrides_test {
namespace {

const char* const kScene = "[medium]\ncount = 20\n[[light]]\nirradiance = [3, 2, 1]\n"
                           "[render]\nmethod = 'isv'\n[render.isv]\nfading = false\nsteps = 3\n";

Scene sceneWith(const std::vector<std::string>& overrides) { return sceneOf(kScene, "scene.toml", overrides); }

std::vector<SettingValue> valuesOf(Scene scene) {
    Light sun = sunOf(scene);
    std::vector<SettingValue> values;
    for (const SceneSetting* setting : liveSettings())
        values.push_back(valueOf(
            *setting,
            {.medium = &scene.medium, .simulation = &scene.simulation, .light = &sun, .render = &scene.render}));
    return values;
}

SceneFeatures featuresOf(const Scene& scene) { return brume::featuresOf(Simulation(scene).now()); }

// Each value of each live setting, alone.
TEST(PresentOverrides, HaveEveryLiveSettingAsItIsNow) {
    const Scene scene = sceneWith({});
    const auto facts = sceneFacts(scene);
    EXPECT_EQ(valuesOf(scene), facts->starts);
    size_t tried = 0;
    for (size_t i = 0; i < facts->starts.size(); ++i)
        for (const SettingValue& value : test::otherValues(*liveSettings()[i], facts->starts[i])) {
            const SceneSetting& setting = *liveSettings()[i];
            if (value == SettingValue(std::string("files"))) continue; // there are none
            std::vector<SettingValue> now = facts->starts;
            now[i] = value;
            Scene present = scene;
            apply({setting.path, value}, {.medium = &present.medium,
                                          .simulation = &present.simulation,
                                          .light = &present.lights.front(),
                                          .render = &present.render});
            const Scene loaded = sceneWith(presentOverrides(*facts, now, featuresOf(present)));
            EXPECT_EQ(loaded.render, present.render) << setting.path;
            EXPECT_EQ(featuresOf(loaded), featuresOf(present)) << setting.path;
            ++tried;
        }
    EXPECT_GT(tried, 60u);
}

// A way may be older or newer than the settings that were told.
TEST(PresentOverrides, HaveAllOfAWayWhateverIsToldOfOthers) {
    const Scene scene = sceneWith({});
    const auto facts = sceneFacts(scene);
    std::vector<SettingValue> told = facts->starts;
    RenderSettings way = scene.render;
    way.rate = 6, way.slabs = 48, way.shadow_error = 0.02f;
    for (size_t i = 0; i < told.size(); ++i) {
        const SceneSetting& setting = *liveSettings()[i];
        if (!setting.path.starts_with("render.") || setting.path == "render.sprites.maps") continue;
        const auto others = test::otherValues(setting, told[i]);
        if (others.empty()) continue;
        apply({setting.path, others.back()}, {.render = &way});
        told[i] = others.front();
    }
    way.method = "froxels";
    EXPECT_EQ(sceneWith(presentOverrides(*facts, told, featuresOf(scene), &way)).render, way);
    EXPECT_EQ(sceneWith(presentOverrides(*facts, told, featuresOf(scene), &scene.render)).render, scene.render)
        << "back to what the scene has";
}

TEST(PresentOverrides, HaveTheFeaturesThatAreAskedForWhateverIsTold) {
    const Scene scene = sceneWith({});
    const auto facts = sceneFacts(scene);
    for (uint32_t bits = 0; bits < 128; ++bits) {
        SceneFeatures wanted{.bodies = (bits & 1) != 0,
                             .lobe = (bits & 2) != 0,
                             .fog = (bits & 4) != 0,
                             .glow = (bits & 12) == 12,
                             .local_lights = (bits & 16) != 0,
                             .sun = (bits & 32) != 0,
                             .emission = (bits & 64) != 0};
        wanted.opaque = wanted.bodies || wanted.local_lights;
        EXPECT_EQ(featuresOf(sceneWith(presentOverrides(*facts, facts->starts, wanted))), wanted) << bits;
    }
}

} // namespace
} // namespace brume::present_overrides_test
