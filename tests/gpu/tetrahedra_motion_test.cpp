// Media of tetrahedra that move, or are seen by who moves.
#include "tests/gpu/tetrahedra_mesh.h"

namespace brume::test::tetrahedra_motion_test {
namespace {

// A push moves corners, and the mesh follows. One that is strong enough folds it: what is drawn then is finite.
TEST_F(TetrahedraTest, APushDeformsTheMesh) {
    const Mesh mesh = lattice(5, 4, 0.15f, soft);
    Scene scene = sceneOf(mesh);
    scene.simulation.impulse_radius = 1;
    const Pose pose = lookAt({3, 4, 9}, {0, 0, 0}, 0.7f);
    Renderer renderer(device(), scene, uint32_t(mesh.points.size()));
    renderer.keepRadiance(true);
    Submission submission(device(), "push");
    const EyeRequest eye{pose, kColumns, kRows};
    const std::vector<glm::vec4> at_rest = [&] {
        submitAndWait(renderer, submission, Simulation(scene), {&eye, 1});
        return renderer.readRadiance();
    }();
    for (const float strength : {0.3f, 10.0f}) {
        Simulation simulation(scene);
        simulation.step(
            {{{.viewer = 1,
               .seq = 1,
               .body = Impulse{.origin = {0.3f, 0.2f, 9}, .direction = {0, 0, -1}, .strength = strength}}}});
        for (int tick = 0; tick < 8; ++tick) simulation.step({});
        std::vector<gpu::Particle> moved(simulation.liveCount());
        simulation.write(moved);
        Mesh now = mesh;
        for (size_t i = 0; i < moved.size(); ++i) now.points[i].centre = moved[i].centre;
        submitAndWait(renderer, submission, simulation, {&eye, 1});
        const std::vector<glm::vec4> pixels = renderer.readRadiance();
        EXPECT_NE(pixels, at_rest);
        double worst = 0;
        for (uint32_t y = 0; y < kRows; ++y)
            for (uint32_t x = 0; x < kColumns; ++x) {
                const glm::vec4& pixel = pixels[size_t(y) * kColumns + x];
                EXPECT_TRUE(std::isfinite(pixel.r) && pixel.a >= 0 && pixel.a <= 1) << x << ' ' << y;
                worst = std::max(worst, std::abs(double(pixel.a) - std::exp(-depthOnPixel(now, pose, x, y))));
            }
        EXPECT_LT(worst, strength < 1 ? 1e-5 : 1.0);
    }
}

// Frames that are a fifth as far apart go on more evenly: a pop would stay as large as it is.
TEST_F(TetrahedraTest, SlowMotionDoesNotPop) {
    constexpr int kFrames = 8;
    const Scene still = sceneOf(centred(6, 4, inner));
    Stage stage(device(), still, uint32_t(still.medium.count));
    const auto roughest = [&](float degrees, bool sun) {
        std::vector<Picture> frames;
        for (int i = 0; i < kFrames; ++i) {
            Scene scene = still;
            const float angle = glm::radians(degrees * (float(i) - 3.5f)); // about an axis of the lattice
            const glm::vec3 from(std::sin(angle), 0, std::cos(angle));
            if (sun) scene.lights[0].to_light = glm::normalize(from + glm::vec3(0, 1, 0));
            const Pose pose = lookAt(sun ? glm::vec3(0, 0, 6) : 6.0f * from, {0, 0, 0}, 0.6f);
            frames.push_back(stage.see(scene, pose, kColumns, kRows));
        }
        float largest = 0, change = 0;
        for (size_t i = 1; i + 1 < kFrames; ++i)
            for (size_t p = 0; p < frames[0].pixels.size(); ++p) {
                const glm::vec4 bend = frames[i - 1].pixels[p] - 2.0f * frames[i].pixels[p] + frames[i + 1].pixels[p];
                largest = std::max(largest, frames[i].pixels[p].r);
                change = std::max(change, std::abs(bend.r));
            }
        return change / largest;
    };
    for (const bool sun : {false, true}) {
        const float coarse = roughest(0.5f, sun), fine = roughest(0.1f, sun);
        std::printf("%s turns: second difference %.5f of the brightest pixel, of larger steps %.5f\n",
                    sun ? "sun" : "eye", double(fine), double(coarse));
        EXPECT_LT(fine, 0.35f * coarse + 2e-4f) << sun;
    }
}

} // namespace
} // namespace brume::test::tetrahedra_motion_test
