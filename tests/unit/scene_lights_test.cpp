// Lights in scene files: which keys each type has, how many there may be, and what a file without the sun means.
#include <string>

#include <gtest/gtest.h>

#include "common/scene.h"
#include "common/scene_limits.h"
#include "tests/unit/scene_file.h"

namespace brume {
namespace {

using test::errorOf, test::written;

constexpr const char* kSpotText = "[[light]]\ntype = \"spot\"\nposition = [1, 2, 3]\naxis = [0, 0, -5]\ninner = 0.1\n"
                                  "outer = 0.2\nrange = 9\nradius = 0.1\nshadows = false\n";

TEST(SceneLights, OfAllTypes) {
    const Scene scene = loadScene(written("[[light]]\n" + std::string(kSpotText) + "[[light]]\ntype = \"point\"\n"));
    ASSERT_EQ(scene.lights.size(), 3u);
    EXPECT_EQ(scene.lights[1].axis, glm::vec3(0, 0, -1));
    EXPECT_EQ(scene.lights[1].position, glm::vec3(1, 2, 3));
    EXPECT_EQ(scene.lights[1].range, 9);
    EXPECT_FALSE(scene.lights[1].shadows);
    EXPECT_EQ(localLightsOf(scene).size(), 2u);
    EXPECT_EQ(sunOf(scene).irradiance, Light().irradiance);
}

TEST(SceneLights, PlacesCountFromTheOrigin) {
    const Scene scene =
        loadScene(written("origin = [1000, 0, 0]\n[[light]]\ntype = \"point\"\nposition = [1001, 2, 3]\n"
                          "pivot = [999, 0, 0]\n"));
    EXPECT_EQ(scene.lights[0].position, glm::vec3(1, 2, 3));
    EXPECT_EQ(scene.lights[0].pivot, glm::vec3(-1, 0, 0));
}

TEST(SceneLights, AFileThatMentionsOthersHasNoSun) {
    EXPECT_EQ(sunOf(loadScene(written(kSpotText))).irradiance, glm::vec3(0));
}

TEST(SceneLights, KeysOfOtherTypesAreRefused) {
    const std::pair<const char*, const char*> refused[] = {
        {"[[light]]\nposition = [1, 2, 3]", "position: not used by this type of light"},
        {"[[light]]\ntype = \"point\"\naxis = [0, 1, 0]", "axis: not used by this type of light"},
        {"[[light]]\ntype = \"spot\"\nirradiance = [1, 1, 1]", "irradiance: not used by this type of light"},
        {"[[light]]\ntype = \"spot\"\ninner = 0.5\nouter = 0.4", "the outer cone is not outside the inner one"},
        {"[[light]]\ntype = \"lamp\"", "\"directional\", \"point\", \"spot\""}};
    for (const auto& [text, why] : refused) EXPECT_NE(errorOf(text).find(why), std::string::npos) << errorOf(text);
}

TEST(SceneLights, ThereAreLimits) {
    EXPECT_NE(errorOf("[[light]]\n[[light]]\n").find("more than one is directional"), std::string::npos);
    const auto points = [](int count, const char* more) {
        std::string text;
        for (int i = 0; i < count; ++i) text += std::string("[[light]]\ntype = \"point\"\n") + more;
        return text;
    };
    EXPECT_EQ(errorOf(points(1024, "shadows = false\n")), "no error");
    EXPECT_NE(errorOf(points(1025, "shadows = false\n")).find("up to 1024"), std::string::npos);
    EXPECT_EQ(errorOf(points(64, "")), "no error");
    EXPECT_NE(errorOf(points(65, "")).find("others with shadows = false"), std::string::npos);
    EXPECT_EQ(errorOf("[medium]\nlayout = \"none\"\n" + points(65, "")), "no error");
}

} // namespace
} // namespace brume
