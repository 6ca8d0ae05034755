// Settings that do as the dissertations print, as a scene has them.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "common/scene.h"

namespace brume::printed_settings_test {
namespace {

std::string refusal(const std::vector<std::string>& set) {
    try {
        loadScene("server/scenes/cloud.toml", set); // tests run in the root of the sources
    } catch (const SceneError& error) {
        return error.what();
    }
    return {};
}

TEST(PrintedSettings, AreReadAndRefused) {
    const Scene scene = loadScene("tools/bench/scenes/isv-default.toml");
    EXPECT_EQ(scene.render.shadow_map, "fronts");
    EXPECT_EQ(scene.render.shadow_extent, 60);
    EXPECT_EQ(scene.render.isv.orientation, "random");
    EXPECT_EQ(scene.render.isv.near, "drop");
    EXPECT_EQ(scene.render.isv.early_return, "fixed");
    const std::vector<std::string> step{"render.isv.taylor_step=0.001"};
    EXPECT_EQ(loadScene("server/scenes/cloud.toml", step).render.isv.taylor_step, 0.001f);
    EXPECT_NE(refusal({"render.shadow_map=slices"}).find("\"sums\", \"fronts\""), std::string::npos);
    EXPECT_NE(refusal({"render.shadow_extent=0"}).find("\"auto\", or a number from 0.1"), std::string::npos);
    EXPECT_NE(refusal({"render.isv.taylor_step=11"}).find("\"auto\", or a number from 0.0001 to 10"),
              std::string::npos);
    EXPECT_NE(refusal({"render.shadow_map=fronts", "medium.model=union"}).find("\"union\" needs \"sums\""),
              std::string::npos);
    EXPECT_EQ(refusal({"render.shadow_map=fronts", "render.shadow_size=8"}), "");
}

} // namespace
} // namespace brume::printed_settings_test
