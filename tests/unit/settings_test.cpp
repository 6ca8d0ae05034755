// The table of settings: every key once, and the tables of the page made from it.
#include "common/settings.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <string>

#include <gtest/gtest.h>

#include "common/settings_tables.h"
#include "server/sim/command.h"

namespace brume {
namespace {

TEST(Settings, StandInTheTableOnceWithTheirTablesTogether) {
    std::set<std::string_view> paths, tables;
    std::string_view table = "none yet";
    for (const SceneSetting& setting : sceneSettings()) {
        EXPECT_TRUE(paths.insert(setting.path).second) << setting.path << " is there twice";
        if (setting.table() != table) {
            EXPECT_TRUE(tables.insert(setting.table()).second) << setting.path << " is away from its table";
        }
        table = setting.table();
        EXPECT_FALSE(setting.help.empty()) << setting.path;
        EXPECT_EQ(setting.help.find_first_of("|\n"), std::string_view::npos) << setting.path;
    }
}

// The tables of a page by their names: what stands below "<!-- settings: NAME -->", up to an empty line.
std::map<std::string, std::string> tablesOf(const std::string& page) {
    constexpr std::string_view kMark = "<!-- settings: ", kEnd = " -->\n\n";
    std::map<std::string, std::string> tables;
    for (size_t at = 0; (at = page.find(kMark, at)) != page.npos;) {
        const size_t name = at + kMark.size(), end = page.find(kEnd, name), table = end + kEnd.size();
        at = std::min(page.find("\n\n", table), page.size() - 1) + 1;
        EXPECT_TRUE(tables.emplace(page.substr(name, end - name), page.substr(table, at - table)).second) << name;
    }
    return tables;
}

TEST(Settings, TheDocumentationHasThemAll) {
    std::ifstream in("docs/scenes.md"); // tests run in the source folder
    const std::string documented{std::istreambuf_iterator<char>(in), {}}, made = settingsTables();
    EXPECT_EQ(tablesOf(documented), tablesOf(made)) << "tools/settings_page.py renews the page";
    size_t rows = 0;
    for (size_t at = 0; (at = made.find("\n| `", at)) != made.npos; ++at) ++rows;
    EXPECT_EQ(rows, sceneSettings().size());
}

TEST(Settings, ALiveOneHasAValueThatACommandCanHave) {
    size_t live = 0;
    for (const SceneSetting& setting : sceneSettings()) {
        EXPECT_EQ(liveSetting(setting.path), setting.live() && !setting.in_list ? &setting : nullptr);
        if (!setting.live()) continue;
        std::string path(setting.path);
        if (setting.in_list) path.insert(path.find('.'), "[0]");
        EXPECT_EQ(liveSetting(path), &setting) << path;
        ++live;
        EXPECT_NO_THROW(defaultOf(setting)) << setting.path;
        EXPECT_NO_THROW(Change(path, defaultOf(setting))) << path;
    }
    EXPECT_GE(live, 13u);
    EXPECT_EQ(liveSetting("medium.cuont"), nullptr);
    EXPECT_THROW(Change("medium.count", 3u), std::invalid_argument) << "not live";
    EXPECT_THROW(Change("render.isv.steps", 3.0f), std::invalid_argument) << "a whole number";
}

// What a setting is once a command has set it to `value`.
SettingValue whenSet(const SceneSetting& setting, const SettingValue& value) {
    Scene scene;
    Light light;
    Fog fog;
    Plane plane;
    Box box;
    Sphere sphere;
    const SceneParts parts{.scene = &scene,
                           .medium = &scene.medium,
                           .simulation = &scene.simulation,
                           .light = &light,
                           .fog = &fog,
                           .plane = &plane,
                           .box = &box,
                           .sphere = &sphere,
                           .sky = &scene.sky,
                           .render = &scene.render};
    std::string path(setting.path);
    if (setting.in_list) path.insert(path.find('.'), "[0]");
    apply(Change(path, value), parts);
    return valueOf(setting, parts);
}

TEST(Settings, ALiveOneCanBeSetToItsDefault) {
    for (const SceneSetting& setting : sceneSettings()) {
        if (!setting.live() || setting.form == Form::direction) continue; // a direction is made a unit vector
        EXPECT_EQ(whenSet(setting, defaultOf(setting)), defaultOf(setting)) << setting.path;
    }
}

TEST(Settings, ValuesBelowTheLeastBecomeTheLeast) {
    const SceneSetting &exposure = *liveSetting("render.exposure"), &steps = *liveSetting("render.isv.steps");
    EXPECT_EQ(whenSet(exposure, 1e-6f), SettingValue(float(exposure.allowed.lo)));
    EXPECT_EQ(whenSet(steps, 0u), SettingValue(uint32_t(steps.allowed.lo)));
}

// Commands have no word for kAuto, which lies outside of what is allowed.
TEST(Settings, NoLiveOneIsAutomatic) {
    for (const SceneSetting& setting : sceneSettings())
        EXPECT_FALSE(setting.live() && setting.form == Form::or_auto) << setting.path;
}

// The controls of figure 14 of seed 000: docs/results/seed-000.md says how each is changed.
TEST(Settings, TheDissertationsControlsAreLive) {
    for (const char* path : {"medium.albedo", "medium.extinction", "medium.falloff", "medium.anisotropy",
                             "medium.asymmetry", "light.to_light", "light.irradiance", "light.rotate",
                             "simulation.paused", "box[0].centre", "sphere[0].centre"}) {
        ASSERT_NE(liveSetting(path), nullptr) << path;
        EXPECT_EQ(liveSetting(path)->changed_by, ChangedBy::controllers) << path;
    }
    for (const char* path : {"render.method", "render.isv.quadrature", "render.isv.steps", "render.isv.fading",
                             "render.isv.soft_shadows", "render.isv.multiple"}) {
        ASSERT_NE(liveSetting(path), nullptr) << path;
        EXPECT_EQ(liveSetting(path)->changed_by, ChangedBy::operators) << path;
    }
    for (const char* path : {"medium.count", "medium.scale"})
        EXPECT_EQ(liveSetting(path), nullptr) << path << ": it needs another scene";
}

} // namespace
} // namespace brume
