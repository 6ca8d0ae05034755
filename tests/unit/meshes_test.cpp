// [[mesh]] of scene files: where triangles are, and what is refused.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "common/scene_text.h"
#include "tests/unit/gltf_file.h"
#include "tests/unit/scene_file.h"

namespace brume {
namespace {

using test::errorOf, test::GltfFile, test::written;

TEST(Meshes, AreScaledTurnedAndPlaced) {
    written(GltfFile().glb(), "triangle.glb");
    const Scene scene = loadScene(written(R"(
origin = [1000, 0, 0]
[[mesh]]
file = "triangle.glb"
position = [1001, 2, 3]
scale = 10
yaw = 1.5707963267948966
[[mesh]]
file = "triangle.glb"
)"));
    ASSERT_EQ(scene.triangles.size(), 2u);
    EXPECT_EQ(scene.triangles[0].corners[0], glm::vec3(1, 2, 3));
    EXPECT_LT(glm::distance(scene.triangles[0].corners[1], glm::vec3(1, 2, -7)), 1e-5f); // as a box of that yaw turns
    EXPECT_EQ(scene.triangles[0].corners[2], glm::vec3(1, 12, 3));
    EXPECT_EQ(scene.triangles[0].albedo, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(scene.triangles[1].corners[0], glm::vec3(0)); // a place that is left out counts from the origin
    const std::string saved = sceneToml(scene);
    EXPECT_NE(saved.find("file = 'triangle.glb'\nposition = [1001, 2, 3]\nscale = 10\n"), std::string::npos) << saved;
    EXPECT_EQ(loadScene(written(saved)).triangles.size(), 2u);
}

TEST(Meshes, WithoutAnAreaAreRefused) {
    GltfFile file;
    file.places = {0, 0, 0, 1, 1, 1, 2, 2, 2};
    written(file.glb(), "line.glb");
    EXPECT_NE(errorOf("[[mesh]]\nfile = \"line.glb\"").find("no triangle has an area"), std::string::npos);
    written(GltfFile().glb(), "triangle.glb");
    EXPECT_NE(errorOf("[[mesh]]\nfile = \"triangle.glb\"\nposition = [40000, 0, 0]\nscale = 1e-6")
                  .find("no triangle has an area"),
              std::string::npos); // smaller than the roundings there
}

TEST(Meshes, RefusalsAreOneLine) {
    EXPECT_NE(errorOf("[[mesh]]").find("mesh[0].file: a mesh without a file"), std::string::npos);
    EXPECT_NE(errorOf("[[mesh]]\nfile = \"none.glb\"").find("none.glb is no file"), std::string::npos);
    written(GltfFile().glb(), "triangle.glb");
    EXPECT_NE(errorOf("[[mesh]]\nfile = \"triangle.glb\"\nscale = 1e6").find("within 50 km"), std::string::npos);
    EXPECT_NE(errorOf("[[mesh]]\nfile = \"triangle.glb\"\nscale = 0").find("mesh[0].scale: 0 is not"),
              std::string::npos);
}

} // namespace
} // namespace brume
