// Meshes against the double-precision reference: what is seen, the sun's shafts past them, lamps, and hard cases.
#include <gtest/gtest.h>

#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::mesh_test {
namespace {

constexpr double kMesh = 1e-2; // relative RMSE

class MeshTest : public JudgedTest {
protected:
    static Scene foggy() {
        Scene scene;
        scene.medium.layout = Layout::none;
        scene.planes = {{0, glm::vec3(0.3f)}};
        scene.lights = {Light{}};
        scene.lights[0].to_light = glm::normalize(glm::vec3(0.4f, 0.8f, 0.45f));
        scene.fogs = {{.extinction = 0.04f, .hi = 15}};
        scene.render.rate = 2;
        scene.render.slabs = 128;
        return scene;
    }

    static void addQuad(Scene& scene, glm::vec3 a, glm::vec3 b, glm::vec3 c, glm::vec3 d, glm::vec3 albedo) {
        scene.triangles.push_back({{a, b, c}, albedo});
        scene.triangles.push_back({{a, c, d}, albedo});
    }

    // A closed, bumpy ball of 2 rings (rings - 1) triangles.
    static void addBall(Scene& scene, glm::vec3 centre, float radius, int rings, glm::vec3 albedo) {
        const auto at = [&](int i, int k) {
            const float polar = float(kPi) * float(i) / float(rings), around = 2 * float(kPi) * float(k) / float(rings);
            const float r = i == 0 || i == rings ? radius : radius * (1 + 0.15f * std::sin(5 * polar + 3 * around));
            return centre + r * glm::vec3(std::sin(polar) * std::cos(around), std::cos(polar),
                                          std::sin(polar) * std::sin(around));
        };
        for (int i = 0; i < rings; ++i)
            for (int k = 0; k < rings; ++k) {
                const int n = (k + 1) % rings;
                if (i + 1 < rings) scene.triangles.push_back({{at(i, k), at(i + 1, k), at(i + 1, n)}, albedo});
                if (i > 0) scene.triangles.push_back({{at(i, k), at(i + 1, n), at(i, n)}, albedo});
            }
    }

    // A lattice of bars of no thickness, which throws many shafts.
    static void addLattice(Scene& scene, float height) {
        for (int i = -4; i <= 4; ++i)
            addQuad(scene, {float(i) - 0.2f, height, -5}, {float(i) + 0.2f, height, -5},
                    {float(i) + 0.2f, height + 0.5f, 5}, {float(i) - 0.2f, height + 0.5f, 5}, glm::vec3(0.5f));
    }
};

TEST_F(MeshTest, ShaftsOfTheSun) {
    Scene scene = foggy();
    addLattice(scene, 5);
    addBall(scene, {0, 2, 0}, 1.2f, 24, {0.6f, 0.5f, 0.4f});
    judge(scene, {lookAt({8, 3, 9}, {0, 2.5f, 0}, 0.9f), lookAt({0.2f, 1, 3}, {0, 4, 0}, 1.1f)}, kMesh);
}

TEST_F(MeshTest, TheHall) {
    const Scene scene = loadScene("server/scenes/atrium-mesh.toml");
    judge(scene, {lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y)}, kMesh);
}

TEST_F(MeshTest, Lamps) {
    Scene scene = foggy();
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0.002f)};
    scene.lights = {{.type = kPoint, .position = {-2, 4, 1}, .range = 30, .radius = 0.1f},
                    {.type = kSpot,
                     .position = {3, 6, -2},
                     .range = 25,
                     .radius = 0.1f,
                     .axis = glm::normalize(glm::vec3(-3, -5, 2))}};
    addBall(scene, {0, 2, 0}, 1.2f, 16, {0.6f, 0.5f, 0.4f});
    addLattice(scene, 3);
    judge(scene, {lookAt({8, 3, 9}, {0, 2.5f, 0}, 0.9f), lookAt({-6, 1, -4}, {1, 2, 1}, 0.9f)}, kMesh);
}

TEST_F(MeshTest, WithObjectsAndParticles) {
    Scene scene = sceneOf(randomPoints(60, 6, 2, 0.5f));
    scene.planes = {{-3, glm::vec3(0.3f)}};
    scene.boxes = {{{2, 0, 1}, {1, 5, 1}, 0.4f, glm::vec3(0.5f)}};
    addBall(scene, {-1, 0, 0}, 1.5f, 16, {0.6f, 0.5f, 0.4f});
    scene.render.rate = 2;
    scene.render.slabs = 128;
    judge(scene, {lookAt({9, 3, 9}, {0, 0, 0}, 0.8f)}, kMesh);
}

TEST_F(MeshTest, CameraInsideAMesh) {
    Scene scene = foggy();
    addBall(scene, {0, 3, 0}, 2.5f, 20, {0.6f, 0.5f, 0.4f});
    scene.triangles.erase(scene.triangles.begin(), scene.triangles.begin() + 60); // the sun comes in at its top
    judge(scene, {lookAt({0.3f, 2.2f, 1}, {-1, 2.5f, -1}, 1.2f)}, kMesh);
}

// More than the tree has all orders of.
TEST_F(MeshTest, ManyTriangles) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = foggy();
    addBall(scene, {0, 2, 0}, 1.2f, 360, {0.6f, 0.5f, 0.4f});
    ASSERT_GT(scene.triangles.size(), gpu::kMostInAllOrders);
    judge(scene, {lookAt({8, 3, 9}, {0, 2.5f, 0}, 0.9f), lookAt({0.2f, 6, 0.1f}, {0, 2, 0}, 1.1f)}, kMesh);
}

TEST_F(MeshTest, OneTriangle) {
    Scene scene = foggy();
    scene.triangles = {{{{-2, 3, -1}, {2, 3.5f, -1}, {0, 3, 2}}, glm::vec3(0.5f)}};
    judge(scene, {lookAt({6, 2, 7}, {0, 2, 0}, 0.9f)}, kMesh);
}

// Centimetres and tens of kilometres.
TEST_F(MeshTest, TinyAndHuge) {
    Scene tiny = foggy();
    tiny.planes.clear();
    tiny.fogs[0] = {.extinction = 2, .hi = 0.3f};
    addBall(tiny, {0, 0, 0}, 0.012f, 16, {0.6f, 0.5f, 0.4f});
    judge(tiny, {lookAt({0.05f, 0.06f, 0.14f}, {0, 0, 0}, 0.6f)}, kMesh);
    Scene huge = foggy();
    huge.planes.clear();
    huge.fogs[0] = {.extinction = 2e-5f, .hi = 3e4f};
    addBall(huge, {0, 8e3f, 0}, 9e3f, 16, {0.6f, 0.5f, 0.4f});
    judge(huge, {lookAt({3e4f, 1e4f, 3e4f}, {0, 5e3f, 0}, 0.7f)}, kMesh);
}

} // namespace
} // namespace brume::test::mesh_test
