// Media that are volumes, on the device: pictures of the methods that read nodes against the reference.
#include <cmath>
#include <fstream>

#include "common/volume/volume.h"
#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::volumes_test {
namespace {

// A cube of `side` voxels a side, `width` m wide, around the origin.
template <class Extinction>
Scene sceneOf(uint32_t side, float width, const Extinction& extinction) {
    auto volume = std::make_shared<Volume>();
    volume->size = glm::uvec3(side);
    volume->spacing = double(width) / side;
    volume->origin = glm::dvec3(-0.5 * (side - 1) * volume->spacing);
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                volume->extinction.push_back(
                    extinction(glm::vec3(volume->origin + volume->spacing * glm::dvec3(x, y, z))));
    Scene scene = test::sceneOf({Point{}});
    scene.medium.layout = Layout::volume;
    scene.medium.model = kVolumeMedium;
    scene.volume = volume;
    scene.render.method = "grid";
    scene.render.shadow_slices = 64;
    return scene;
}

// Three lumps with details down to two voxels.
float lumps(glm::vec3 x) {
    float sum = 0;
    for (const glm::vec3 c : {glm::vec3(-1, 0, 0), glm::vec3(1, 0.5f, -0.5f), glm::vec3(0.2f, -1, 1)})
        sum += std::exp(-2 * glm::dot(x - c, x - c));
    return std::max(0.8f * sum * (1 + 0.3f * std::sin(6 * x.x) * std::sin(5 * x.y + 2 * x.z)) - 0.05f, 0.0f);
}

const Pose kOutside = lookAt({3, 4, 9}, {0, 0, 0}, 0.7f), kInside = lookAt({0.5f, 0.2f, 1}, {-2, 0, -1}, 1.2f);

class VolumesTest : public JudgedTest {
protected:
    static void expectError(const Scene& scene, const Pose& pose, double most, const char* what) {
        const Error error = errorOf(scene, pose);
        std::printf("%s: %.4f %%, worst pixel %.3f %%\n", what, 100 * error.rmse, 100 * error.worst);
        EXPECT_LE(error.rmse, most) << what;
    }
};

TEST_F(VolumesTest, TransmittanceIsTheReferences) {
    Scene scene = sceneOf(32, 5, lumps);
    scene.lights[0].irradiance = glm::vec3(0);
    scene.sky.ambient = glm::vec3(1);
    scene.render.rate = 1;
    scene.render.slabs = 384;
    expectError(scene, kOutside, 1e-3, "outside");
    expectError(scene, kInside, 1e-3, "inside");
}

TEST_F(VolumesTest, LitPicturesAreTheReferences) {
    Scene scene = sceneOf(32, 5, lumps);
    scene.render.rate = 1;
    scene.render.slabs = 256;
    expectError(scene, kOutside, 5e-3, "grid");
    scene.medium.centre = {0.5f, 0.3f, -0.2f};
    expectError(scene, kOutside, 5e-3, "moved");
}

TEST_F(VolumesTest, PointsAndFogShineThroughThem) {
    Scene scene = sceneOf(24, 5, lumps);
    scene.lights[0].irradiance = glm::vec3(0);
    scene.lights.push_back({.type = kPoint, .position = {1, 3, 4}, .intensity = glm::vec3(60), .radius = 0.1f});
    scene.fogs.push_back({.extinction = 0.02f});
    scene.render.rate = 1;
    scene.render.slabs = 192;
    expectError(scene, kOutside, 1e-2, "a point and fog");
}

TEST_F(VolumesTest, MethodsThatReadNodesDrawThem) {
    Scene scene = sceneOf(24, 5, lumps);
    for (const char* method : {"froxels", "lit", "march", "gradients"}) {
        scene.render.method = method;
        scene.render.froxels.pixels = 1;
        scene.render.froxels.slices = 128;
        expectError(scene, kOutside, 0.1, method);
    }
}

TEST_F(VolumesTest, OtherMethodsRefuseThem) {
    Scene scene = sceneOf(8, 5, lumps);
    for (const char* method : {"slabs", "tiles", "isv", "sphere"}) {
        scene.render.method = method;
        try {
            render(device(), scene, kOutside, kWidth, kHeight);
            FAIL() << method;
        } catch (const gpu::Error& error) {
            EXPECT_NE(std::string(error.what())
                          .find("it draws no medium.model = \"volume\"; use grid, froxels, lit or march"),
                      std::string::npos)
                << error.what();
        }
    }
}

} // namespace
} // namespace brume::test::volumes_test
