// What moves: a slow orbit through overlapping particles, whose order changes from frame to frame.
#include "common/metrics.h"
#include "tests/gpu/truth.h"
#include "tests/hard/hard.h"

namespace brume::test::orbit_test {
namespace {

constexpr int kFrames = 6;
constexpr uint32_t kWidth = 96, kHeight = 54;

// Half a degree a frame: within the orbit dozens of pairs of overlapping particles change places.
Pose poseOf(int frame) {
    const float angle = glm::radians(0.5f * float(frame));
    return lookAt({9 * std::sin(angle), 1, 9 * std::cos(angle)}, {0, 0, 0}, 0.7f);
}

// Naive: particles sorted by a coarse or unstable key pop; depths clamped to whole slices flicker. The bound is on mean
// FLIP beyond what the true picture changes: 0.002 is a tenth of what the true picture itself changes from frame to
// frame here, and far below what is seen. Fewer changes than the true picture's would be a picture that lags: bounded
// as well.
TEST_F(HardTest, SlowOrbitThroughOverlaps) {
    Scene scene = sceneOf(randomPoints(60, 5, 2.5f, 0.5f), 1.6f);
    scene.lights[0].irradiance = glm::vec3(12);
    scene.render.shadow_size = 128;
    Simulation simulation(scene);
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);

    std::vector<RadianceImage> exact;
    for (int i = 0; i < kFrames; ++i) {
        const reference::Picture seen = truePicture(reference::worldOf({particles, double(scene.medium.falloff), 0, 0},
                                                                       scene.lights[0], reference::Model::overlapping),
                                                    reference::perspective(poseOf(i), int(kWidth), int(kHeight)), 1e-5);
        exact.push_back({seen.width,
                         seen.height,
                         {seen.radiance.begin(), seen.radiance.end()},
                         {seen.transmittance.begin(), seen.transmittance.end()}});
    }
    const std::vector<RadianceImage> still(exact.size(), exact[0]);
    const double own = temporalFlip(exact, still, {});
    EXPECT_GT(own, 0.01) << "nothing to see";
    for (const Way& way : waysAndSampled()) {
        Scene chosen = scene;
        choose(chosen, way);
        std::vector<RadianceImage> frames;
        for (int i = 0; i < kFrames; ++i) {
            RadianceImage frame{int(kWidth), int(kHeight), {}, {}};
            for (const glm::vec4& pixel : plain().see(chosen, poseOf(i), kWidth, kHeight).pixels) {
                frame.radiance.emplace_back(pixel);
                frame.transmittance.push_back(pixel.a);
            }
            frames.push_back(std::move(frame));
        }
        judge("slow orbit through overlaps: mean FLIP between frames beyond the reference's", way,
              std::abs(temporalFlip(frames, exact, {})), 0.002);
    }
}

} // namespace
} // namespace brume::test::orbit_test
