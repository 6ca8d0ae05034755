// Views that should be steady: neither a camera nor a sun that moves slowly makes them pop. In every frame they show
// what is so, whatever the frame before showed.
#include <cmath>
#include <utility>

#include "shaders/shared/transmittance.h"
#include "tests/gpu/light_passes.h"
#include "tests/gpu/shown.h"
#include "tests/layer.h"

namespace brume::test::show_motion_test {
namespace {

class ShowMotionTest : public ShowTest {
protected:
    static constexpr int kFrames = 8;

    // Half a degree a frame, from where particles hide one another.
    static Pose poseOf(int frame) {
        const float angle = glm::radians(0.5f * float(frame));
        return lookAt({9 * std::sin(angle), 0.5f, 9 * std::cos(angle)}, {0, 0, 0}, 0.6f);
    }
    static Scene cloud() { return dense(randomPoints(60, 4, 1.6f, 2, 5), "isv", 0.5f); }
    // The part of the picture's sides where a place is.
    static glm::dvec2 partOf(const Pose& from, glm::vec3 place) {
        const glm::vec3 c = glm::transpose(glm::mat3_cast(from.orientation)) * (place - from.position);
        const float high = std::tan(0.3f), wide = high * float(kWidth) / float(kHeight);
        return 0.5 * glm::dvec2(1 + c.x / -c.z / wide, 1 - c.y / -c.z / high);
    }
};

TEST_F(ShowMotionTest, DepthIsTheSumInEveryFrame) {
    BRUME_WHOLE_LAYER_ONLY();
    const Scene scene = cloud();
    const std::vector<gpu::Particle> particles = particlesOf(scene);
    for (int frame = 0; frame < kFrames; ++frame) {
        const Pose from = poseOf(frame);
        const Shown shown = see(scene, gpu::kShowDepth, {}, from);
        size_t deep = 0;
        eachPixel(
            [&](uint32_t x, uint32_t y, glm::dvec3 w) {
                double depth = 0;
                for (const gpu::Particle& p : particles) {
                    const double k = physics::gaussianK(double(p.scale), double(scene.medium.falloff));
                    const glm::dvec3 c = glm::dvec3(p.centre) - glm::dvec3(from.position);
                    const double closest = glm::dot(c, w), b2 = glm::dot(c, c) - closest * closest;
                    depth += physics::segmentDepth(double(p.sigma_t), k, b2, k * (0.05 - closest), k * 1e4);
                }
                if (depth < 0.0102) return; // what is behind shows, dimmed
                ++deep;
                ASSERT_LE(apart(shown.at(x, y), colourOf(gpu::kShowDepth, depth)), kLevels)
                    << frame << ' ' << x << ' ' << y;
            },
            from);
        EXPECT_GT(deep, 5000u);
    }
}

// Light at a particle does not depend on who looks: a disc keeps its colour while others pass before and behind it.
TEST_F(ShowMotionTest, DiscsOfLightKeepTheirColours) {
    const Scene scene = cloud();
    const std::vector<gpu::Particle> particles = particlesOf(scene);
    std::vector<glm::ivec3> first(particles.size(), glm::ivec3(-1));
    size_t seen = 0, hidden = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
        const Pose from = poseOf(frame);
        const Shown shown = see(scene, gpu::kShowLight, {}, from);
        for (size_t i = 0; i < particles.size(); ++i) {
            const gpu::Particle& p = particles[i];
            const glm::dvec2 at = partOf(from, p.centre) * glm::dvec2(kWidth, kHeight);
            if (!(at.x >= 0 && at.x < kWidth && at.y >= 0 && at.y < kHeight - kLegendHigh)) continue;
            const auto before = [&](const gpu::Particle& other) { // its disc reaches here, and is nearer or may be
                const glm::vec3 forward = glm::normalize(-from.position), a = other.centre - from.position,
                                b = p.centre - from.position;
                const float depth = glm::dot(forward, a);
                const float off = glm::length(a - b * (depth / glm::dot(forward, b)));
                return &other != &p && depth < glm::dot(forward, b) + 0.01f && off < 0.15f * other.scale + 0.05f;
            };
            if (std::ranges::any_of(particles, before)) {
                ++hidden;
                continue;
            }
            const glm::ivec3 colour = shown.at(uint32_t(at.x), uint32_t(at.y));
            if (first[i].r < 0) first[i] = colour;
            EXPECT_LE(apart(colour, glm::dvec3(first[i])), 1.0) << frame << ' ' << i;
            ++seen;
        }
    }
    EXPECT_GT(seen, size_t(20 * kFrames));
    EXPECT_GT(hidden, 10u);
}

TEST_F(ShowMotionTest, NoCameraChangesTheShadowMap) {
    const Scene scene = cloud();
    const Shown first = see(scene, gpu::kShowShadow, {}, poseOf(0));
    for (int frame = 1; frame < kFrames; ++frame) {
        const Shown shown = see(scene, gpu::kShowShadow, {}, poseOf(frame));
        size_t differ = 0;
        eachPixel([&](uint32_t x, uint32_t y, glm::dvec3) { differ += shown.at(x, y) != first.at(x, y); });
        EXPECT_EQ(differ, 0u) << frame;
    }
}

// Planes stay where they are, and a pixel goes on as it did in the frames before: of smaller steps it changes less.
TEST_F(ShowMotionTest, TheShadowMapOfASlowSunGoesOn) {
    const auto roughest = [](float degrees) {
        std::vector<Shown> frames;
        for (int frame = 0; frame < kFrames; ++frame) {
            Scene scene = cloud();
            scene.render.shadow_size = 32, scene.render.shadow_slices = 8; // one that follows the medium changes size
            const float angle = glm::radians(degrees * float(frame));
            scene.lights[0].to_light = glm::normalize(glm::vec3(std::sin(angle), 1, std::cos(angle)));
            frames.push_back(see(scene, gpu::kShowShadow));
        }
        int change = 0, most = 0;
        eachPixel([&](uint32_t x, uint32_t y, glm::dvec3) {
            for (size_t i = 1; i + 1 < frames.size(); ++i)
                for (int c = 0; c < 3; ++c) {
                    const int before = frames[i - 1].at(x, y)[c], now = frames[i].at(x, y)[c];
                    change = std::max(change, std::abs(before - 2 * now + frames[i + 1].at(x, y)[c]));
                    most = std::max(most, std::abs(now - before));
                }
        });
        std::printf("%.3f degrees a frame: second difference %d, from frame to frame %d, of 255\n", double(degrees),
                    change, most);
        return std::pair(change, most);
    };
    const int coarse = roughest(0.5f).second;
    const auto [change, most] = roughest(0.05f);
    EXPECT_GT(coarse, 8);
    EXPECT_LE(most, coarse / 4);
    EXPECT_LE(change, 6);
}

} // namespace
} // namespace brume::test::show_motion_test
