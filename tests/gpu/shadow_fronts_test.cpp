// The volumetric shadow map as the dissertation has it: whole particles behind their fronts, and a cube of fixed size.
#include <cmath>

#include "server/effects/shadow_volume/shadow_volume.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/light_passes.h"

namespace brume::test::shadow_fronts_test {
namespace {

Scene lit(glm::vec3 to_light, uint32_t size, uint32_t slices, float extent) {
    Scene scene = sceneOf({Point{}}, 1.6f);
    scene.lights[0].to_light = glm::normalize(to_light);
    scene.camera.target = {0.5f, -0.3f, 0.7f};
    scene.render.shadow_size = size;
    scene.render.shadow_slices = slices;
    scene.render.shadow_extent = extent;
    scene.render.shadow_map = "fronts";
    return scene;
}

std::vector<gpu::Particle> particlesOfSizes() {
    std::vector<gpu::Particle> particles;
    Random random(5);
    for (int i = 0; i < 60; ++i)
        particles.push_back({random.inCube(5), random.uniform(0.6f, 4), glm::vec3(1), random.uniform(0.2f, 2)});
    return particles;
}

class ShadowFrontsTest : public GpuTest {
protected:
    ShadowVolume volume_{device(), 600, false, true};
};

// Every texel is the sum of the optical depths of the whole lines through it, of the particles whose fronts lie before
// its plane.
TEST_F(ShadowFrontsTest, TexelsAreTheDoubleSum) {
    const std::vector<gpu::Particle> particles = particlesOfSizes();
    for (const glm::vec3 to_light : {glm::vec3(0.3f, 0.8f, 0.5f), glm::vec3(-3, -1, 2)})
        for (const auto& [size, slices] : {std::pair(8u, 2u), {37u, 10u}, {24u, 20u}, {9u, 100u}})
            for (const float extent : {0.0f, 60.0f}) {
                SCOPED_TRACE(testing::Message() << size << " texels, " << slices << " planes, " << extent << " m");
                const Scene scene = lit(to_light, size, slices, extent);
                gpu::Tick tick;
                const std::vector<float> texels = shadowTexels(device(), volume_, scene, particles, tick);
                ASSERT_EQ(tick.map.texels, glm::uvec2(size));
                const glm::dvec3 cell = glm::dvec3(tick.map.hi - tick.map.lo) / glm::dvec3(size, size, slices - 1.0);
                double largest = 0;
                int lit_texels = 0, shadowed = 0;
                for (uint32_t plane = 0; plane < slices; ++plane)
                    for (uint32_t y = 0; y < size; ++y)
                        for (uint32_t x = 0; x < size; ++x) {
                            double exact = 0, unsure = 0; // depth of particles whose plane is a matter of rounding
                            for (const gpu::Particle& p : particles) {
                                const glm::dvec3 c(p.centre), light(tick.sun.to_light);
                                const glm::dvec2 off(
                                    glm::dot(c, glm::dvec3(tick.map.x)) - double(tick.map.lo.x) - cell.x * (x + 0.5),
                                    glm::dot(c, glm::dvec3(tick.map.y)) - double(tick.map.lo.y) - cell.y * (y + 0.5));
                                const double s = 0.16 * double(p.scale);
                                const double depth = std::sqrt(2 * kPi) * double(p.sigma_t) * s *
                                                     std::exp(-0.5 * glm::dot(off, off) / (s * s));
                                const double front =
                                    (double(tick.map.hi.z) - glm::dot(c, light) - double(p.scale)) / cell.z;
                                if (plane > 0 && double(plane) >= front) exact += depth;
                                if (plane > 0 && std::abs(double(plane) - front) < 1e-4) unsure += depth;
                            }
                            const double got = double(texels[(size_t(plane) * size + y) * size + x]);
                            const double left_out = double(tick.cut) * double(particles.size());
                            ASSERT_NEAR(got, exact, 1e-4 * exact + left_out + unsure) << plane << ": " << x << ' ' << y;
                            largest = std::max(largest, got);
                            (got > 0.01 ? shadowed : lit_texels) += plane > 0;
                        }
                EXPECT_GT(largest, 0.1);
                EXPECT_GT(shadowed, 0);
                EXPECT_GT(lit_texels, 0);
            }
}

TEST_F(ShadowFrontsTest, TheExtentIsACubeAroundTheTarget) {
    for (const char* map : {"sums", "fronts"}) {
        Scene scene = lit({0.3f, 0.8f, 0.5f}, 16, 10, 60);
        scene.render.shadow_map = map;
        const gpu::Tick tick = tickOf(scene, particlesOfSizes());
        const glm::vec3 middle = 0.5f * (tick.map.lo + tick.map.hi), target = scene.camera.target;
        EXPECT_NEAR(middle.x, glm::dot(tick.map.x, target), 1e-5f);
        EXPECT_NEAR(middle.y, glm::dot(tick.map.y, target), 1e-5f);
        EXPECT_NEAR(middle.z, glm::dot(tick.sun.to_light, target), 1e-5f);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(tick.map.hi[i] - tick.map.lo[i], 60, 1e-4f);
        scene.render.shadow_extent = 0;
        const gpu::Tick fitted = tickOf(scene, particlesOfSizes());
        EXPECT_LT(fitted.map.hi.z - fitted.map.lo.z, 30);
    }
}

// A front lies 6 m before its particle's centre here, though the Gaussian's deviation is 1 m. So places are shadowed
// far too early, and more planes do not help: the light in the cloud stays half of what it is. Sums of 20 planes are
// right.
TEST_F(ShadowFrontsTest, PlanesDoNotRemoveTheirBias) {
    Scene scene = loadScene("server/scenes/cloud.toml");
    scene.render.method = "sphere";
    scene.render.cutoff = 1e-3f;
    scene.render.shadow_size = 128;
    scene.sky = {glm::vec3(0), glm::vec3(0), glm::vec3(0)};
    const Pose pose = lookAt({0, 2, 26}, {0, 0, 0}, 0.6f);
    const auto seen = [&](const char* map, uint32_t planes) {
        scene.render.shadow_map = map;
        scene.render.shadow_slices = planes;
        return render(device(), scene, pose, 48, 36);
    };
    const Picture exact = seen("sums", 193);
    const auto bias = [&](const Picture& picture) {
        double sum = 0, all = 0;
        for (size_t i = 0; i < picture.pixels.size(); ++i)
            sum += double(picture.pixels[i].g - exact.pixels[i].g), all += double(exact.pixels[i].g);
        return sum / all;
    };
    const double few = bias(seen("fronts", 20)), many = bias(seen("fronts", 100)), most = bias(seen("fronts", 193)),
                 of_sums = bias(seen("sums", 20));
    EXPECT_LT(std::abs(of_sums), 0.005);
    EXPECT_LT(most, -0.45);
    EXPECT_GT(most, -0.6);
    EXPECT_NEAR(few, most, 0.01);
    EXPECT_NEAR(many, most, 0.01);
}

} // namespace
} // namespace brume::test::shadow_fronts_test
