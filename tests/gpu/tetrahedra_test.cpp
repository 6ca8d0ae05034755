// Media of tetrahedra on the device: depths against intervals found in double, and pictures against the reference.
#include "common/tetrahedra.h"
#include "server/plan/memory.h"
#include "tests/gpu/tetrahedra_mesh.h"
#include "tests/layer.h"

namespace brume::test::tetrahedra_test {
namespace {

TEST_F(TetrahedraTest, TransmittanceIsThatOfAllIntervals) {
    const Pose outside = lookAt({3, 4, 9}, {0, 0, 0}, 0.7f);
    EXPECT_LT(worstTransmittance(lattice(1, 4, 0, even), outside), 1e-5);
    EXPECT_LT(worstTransmittance(lattice(5, 4, 0.15f, soft), outside), 1e-5);
    EXPECT_LT(worstTransmittance(lattice(5, 4, 0.15f, soft), lookAt({0.3f, 0.2f, 0.1f}, {2, 0, 1}, 1.5f)), 1e-5)
        << "from within";
    Mesh stretched = lattice(5, 4, 0.15f, soft);
    for (Point& point : stretched.points) point.centre *= glm::vec3(8, 1, 0.2f);
    EXPECT_LT(worstTransmittance(stretched, lookAt({9, 2, 6}, {0, 0, 0}, 0.9f)), 1e-5) << "slivers";
}

// The middle column and row of pixels, and its diagonals, lie in planes of faces; the middle one goes through corners.
// A line in the plane of an outside face is in the mesh or beside it: there is no medium there.
TEST_F(TetrahedraTest, RaysThroughCornersAndEdgesLoseNothing) {
    for (const Mesh& mesh : {lattice(4, 4, 0, inner), centred(4, 4, inner), centred(5, 4, inner)}) {
        for (const glm::vec3 from : {glm::vec3(0, 0, 9), glm::vec3(9, 0, 0), glm::vec3(0, 8, 0.001f),
                                     glm::vec3(5, 5, 5), glm::vec3(5, 0, 5), glm::vec3(0, 0, 1), glm::vec3(0.5f)})
            EXPECT_LT(worstTransmittance(mesh, lookAt(from, {0, 0, 0}, 0.8f)), 2e-5)
                << mesh.cells.size() << " from " << from.x << ' ' << from.y << ' ' << from.z;
        for (const float aside : {0.5f, 1.0f}) // along lines through middles of cubes, and along edges
            EXPECT_LT(worstTransmittance(mesh, lookAt({aside, aside, 9}, {aside, aside, 0}, 0.8f)), 2e-5) << aside;
    }
}

TEST_F(TetrahedraTest, HolesAndSeparatePiecesAreMetInOrder) {
    Mesh mesh = lattice(6, 4, 0.1f, even);
    Random random(3);
    std::erase_if(mesh.cells, [&](glm::uvec4) { return random.uniform(0, 1) < 0.4f; });
    EXPECT_LT(worstTransmittance(mesh, lookAt({3, 4, 9}, {0, 0, 0}, 0.7f)), 1e-5);
    EXPECT_LT(worstTransmittance(mesh, lookAt({0.3f, 0.2f, 0.1f}, {2, 0, 1}, 1.5f)), 1e-5) << "from within";
}

TEST_F(TetrahedraTest, PiecesThatTouchAreAsOne) {
    const Mesh one = lattice(4, 4, 0.15f, soft);
    Mesh apart; // every tetrahedron has corners of its own
    for (const glm::uvec4 cell : one.cells) {
        apart.cells.emplace_back(uint32_t(apart.points.size()) + glm::uvec4(0, 1, 2, 3));
        for (int m = 0; m < 4; ++m) apart.points.push_back(one.points[cell[m]]);
    }
    EXPECT_LT(worstTransmittance(apart, lookAt({3, 4, 9}, {0, 0, 0}, 0.7f)), 1e-5);
    EXPECT_LT(worstTransmittance(apart, lookAt({0.3f, 0.2f, 0.1f}, {2, 0, 1}, 1.5f)), 1e-5) << "from within";
    const glm::vec3 corner = one.points[one.cells.size() / 12].centre, edge = 0.5f * (corner + one.points[63].centre);
    for (const glm::vec3 from : {corner, edge})
        EXPECT_LT(worstTransmittance(apart, lookAt(from, {0, 0, 5}, 1.5f)), 1e-5) << "from where pieces touch";
}

TEST_F(TetrahedraTest, OpticalDepthsFromAThousandthToAThousandHold) {
    const Pose pose = lookAt({1, 2, 6}, {0, 0, 0}, 0.7f);
    for (const float depth : {1e-3f, 1e-1f, 10.0f, 1e3f}) {
        const Mesh mesh = lattice(3, 4, 0.15f, [&](glm::vec3) { return depth / 4; });
        EXPECT_LT(worstTransmittance(mesh, pose), 3e-5) << depth; // places are rounded by some 1e-7 m: 250/m
        Scene scene = sceneOf(mesh);
        scene.sky.ambient = glm::vec3(1); // a medium of albedo 1 in even light of radiance 1 has that, too
        scene.lights[0].irradiance = glm::vec3(0);
        const Picture picture = render(device(), scene, pose, kColumns, kRows);
        for (const glm::vec4& pixel : picture.pixels) EXPECT_NEAR(double(pixel.r + pixel.a), 1, 2e-5) << depth;
        const double opacity = -std::expm1(-depthOnPixel(mesh, pose, kColumns / 2, kRows / 2));
        const double drawn = double(picture.at(kColumns / 2, kRows / 2).r);
        EXPECT_NEAR(drawn / opacity, 1, 1e-4) << depth; // relative: a thin medium loses nothing
    }
}

TEST_F(TetrahedraTest, ShadowsOfTheSunAreExactAtPlanes) {
    const struct {
        Mesh mesh;
        glm::vec3 to_light;
        uint32_t texels; // of the last one columns lie on lines of the lattice
    } cases[]{{lattice(5, 4, 0.15f, soft), glm::normalize(glm::vec3(0.3f, 0.8f, 0.5f)), 256},
              {centred(4, 4, inner), {0, 1, 0}, 33}};
    for (const auto& [mesh, to_light, texels] : cases) {
        Scene scene = sceneOf(mesh);
        scene.lights[0].to_light = to_light;
        scene.render.shadow_size = texels;
        scene.render.shadow_slices = 16;
        EXPECT_LT(worstShadow(scene, mesh), 2e-5) << texels;
    }
}

TEST_F(TetrahedraTest, MemoryIsWhatIsPredicted) {
    const Scene scene = sceneOf(centred(6, 4, soft));
    const uint64_t before = device().memoryInUse();
    const TetrahedraBuffers buffers(device(), scene.tetrahedra);
    const uint64_t took = device().memoryInUse() - before, predicted = tetrahedraMemory(&*scene.tetrahedra).device;
    EXPECT_EQ(buffers.cells.size() + buffers.faces.size() + buffers.nodes.size(), predicted);
    EXPECT_LT(took - predicted, 64u << 10) << "alignment";
}

TEST_F(TetrahedraTest, PicturesAreThoseOfTheReference) {
    Mesh mesh = lattice(6, 4, 0.15f, soft);
    Scene scene = sceneOf(mesh);
    const Pose outside = lookAt({3, 4, 7}, {0, 0, 0}, 0.8f), within = lookAt({0.3f, 0.2f, 0.1f}, {2, 0, 1}, 1.2f);
    const auto judged = [&](const char* name, const Pose& pose) {
        const Error error = errorOf(scene, pose);
        std::printf("%-10s %.4f %%, worst pixel %.3f %%\n", name, 100 * error.rmse, 100 * error.worst);
        EXPECT_LT(error.rmse, kAllowed) << name;
    };
    judged("outside", outside);
    judged("within", within);
    for (Point& point : mesh.points) point.albedo = 0.5f + 0.1f * point.centre, point.sigma_t *= 3;
    scene = sceneOf(mesh);
    scene.medium.anisotropy = 1;
    scene.medium.asymmetry = 0.6f;
    scene.sky.ambient = glm::vec3(0.05f);
    judged("coloured", outside);
    scene.medium.extinction_colour = {1, 0.6f, 0.3f};
    judged("hues", outside);
}

TEST_F(TetrahedraTest, ObjectsEndRaysAndShadowTheMedium) {
    Scene scene = sceneOf(lattice(6, 4, 0.15f, soft));
    scene.planes = {{.height = -2}};
    scene.boxes = {{.centre = {0.5f, 1.2f, 0}, .size = {1, 0.3f, 1}, .yaw = 0.4f}};
    scene.render.tetrahedra.nodes = 3;
    const Error error = errorOf(scene, lookAt({3, 4, 7}, {0, 0, 0}, 0.8f));
    std::printf("objects    %.4f %%, worst pixel %.3f %%\n", 100 * error.rmse, 100 * error.worst);
    EXPECT_LT(error.rmse, kAllowed);
}

// A mesh that ends at once: within a texel or between two planes of the map the light's depth is no line.
TEST_F(TetrahedraTest, HardOutsidesAreLit) {
    for (const float sigma : {0.3f, 3.0f, 30.0f, 300.0f})
        for (const uint32_t side : {1u, 5u}) {
            Scene scene = sceneOf(lattice(side, 4, 0, [&](glm::vec3) { return sigma; }));
            const Error error = errorOf(scene, lookAt({6, 5, 8}, {0, 0, 0}, 0.7f));
            std::printf("extinction %3g, %4u: %.4f %%, worst pixel %.3f %%\n", double(sigma), 6 * side * side * side,
                        100 * error.rmse, 100 * error.worst);
            EXPECT_LT(error.rmse, 0.003) << sigma << ' ' << side;
        }
}

// Light changes along a thick or long tetrahedron, and objects' shadows end within it.
TEST_F(TetrahedraTest, CoarseMeshesAreAsFineOnes) {
    for (const float sigma : {0.05f, 0.5f, 2.0f})
        for (const bool box : {false, true}) {
            Scene scene = sceneOf(lattice(1, 8, 0, [&](glm::vec3) { return sigma; }));
            scene.lights[0].to_light = glm::normalize(glm::vec3(0.1f, 1, 0.2f));
            if (box) scene.boxes = {{.centre = {2.5f, 4.5f, 1.8f}, .size = {1.5f, 0.4f, 2}, .yaw = 0.3f}};
            const Error error = errorOf(scene, lookAt({1, 0.8f, 1.2f}, {3, -0.5f, 2}, 1.1f));
            std::printf("extinction %4g%s: %.4f %%, worst pixel %.3f %%\n", double(sigma), box ? ", box" : "",
                        100 * error.rmse, 100 * error.worst);
            EXPECT_LT(error.rmse, 0.003) << sigma << ' ' << box;
        }
}

// A mesh as fine as its particles' detail is drawn as slabs draw the particles, with light that scatters again, too.
TEST_F(TetrahedraTest, ScatteringIsThatOfSlabs) {
    BRUME_WHOLE_LAYER_ONLY();
    const Point blob{.scale = 10, .sigma_t = 1.2f, .albedo = glm::vec3(0.9f, 0.95f, 1)};
    const auto gaussian = [&](glm::vec3 at) { return blob.sigma_t * std::exp(-50 * glm::dot(at, at) / 100); };
    Mesh mesh = centred(20, 8, gaussian);
    for (Point& point : mesh.points) point.albedo = blob.albedo;
    Scene of_mesh = sceneOf(mesh), of_blob = test::sceneOf({blob});
    of_blob.render.method = "slabs";
    of_blob.render.rate = 1;
    const Pose pose = lookAt({3, 4, 9}, {0, 0, 0}, 0.8f);
    for (const bool box : {false, true}) {
        for (Scene* scene : {&of_mesh, &of_blob}) {
            scene->render.shadow_size = 64, scene->render.shadow_slices = 64;
            scene->medium.anisotropy = 1, scene->medium.asymmetry = 0.5f;
            if (box) scene->boxes = {{.centre = {0.6f, 2.5f, 1}, .size = {3, 0.2f, 3}, .albedo = glm::vec3(0)}};
        }
        Stage mesh_stage(device(), of_mesh, uint32_t(mesh.points.size())), blob_stage(device(), of_blob, 1);
        for (const char* scattering : {"single", "octaves", "propagation"}) {
            // Slabs shadow the octaves of a ray all alike, by the part of its sunlight that objects let through.
            if (box && std::string(scattering) == "octaves") continue;
            of_mesh.render.scattering = of_blob.render.scattering = scattering;
            const Picture a = mesh_stage.see(of_mesh, pose, kColumns, kRows),
                          b = blob_stage.see(of_blob, pose, kColumns, kRows);
            double errors = 0, values = 0;
            for (size_t i = 0; i < a.pixels.size(); ++i) {
                const glm::dvec3 off(a.pixels[i] - b.pixels[i]), value(b.pixels[i]);
                errors += glm::dot(off, off), values += glm::dot(value, value);
            }
            std::printf("%-12s%s %.2f %%\n", scattering, box ? " box" : "    ", 100 * std::sqrt(errors / values));
            EXPECT_LT(std::sqrt(errors / values), 0.03) << scattering << box;
        }
    }
}

} // namespace
} // namespace brume::test::tetrahedra_test
