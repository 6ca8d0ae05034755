// Method gradients: the values of gradients, against differences in double.
#include <gtest/gtest.h>

#include "tests/gpu/closed_form.h"
#include "tests/layer.h"

namespace brume::test::radiance_planes_test {
namespace {

constexpr uint32_t kWidth = 33, kHeight = 25;

class RadiancePlanesTest : public GpuTest {
protected:
    static double difference(const Picture& a, const Picture& b) {
        double off = 0, all = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i) {
            const glm::dvec3 p(a.pixels[i]), q(b.pixels[i]);
            off += glm::dot(p - q, p - q), all += glm::dot(q, q);
        }
        return std::sqrt(off / all);
    }
};

// A lamp 2 km away, whose light the medium does not shadow. In the spheres of samples its light is linear but for
// 3 (r / 2 km)^2, 1e-6 of it. The medium is so dense that next to none of it is left dark outside of all spheres.
// Planes are that light; means without gradients err by 2 r / 2 km.
TEST_F(RadiancePlanesTest, ALinearFieldIsReproduced) {
    Scene scene = sceneOf(randomPoints(60, 4, 3, 10), 1);
    scene.lights = {{.type = kPoint, .position = {1200, -960, 1280}, .intensity = glm::vec3(4e9f), .shadows = false}};
    scene.render.method = "gradients";
    scene.render.froxels = {.pixels = 1, .slices = 64};
    const Pose pose = lookAt({2, 1.5f, 7}, {0, 0, 0}, 0.7f);
    Stage stage(device(), scene, 60);
    const auto seen = [&](const char* interpolation) {
        scene.render.radiance = {.interpolation = interpolation, .quantity = "radiance", .levels = 0, .spacing = 0.25f};
        return stage.see(scene, pose, kWidth, kHeight);
    };
    const Picture exact = seen("exact");
    const double planes = difference(seen("gradient"), exact), means = difference(seen("rbf"), exact);
    std::printf("planes %.1e, means %.1e\n", planes, means);
    EXPECT_LE(planes, 1e-5);
    EXPECT_GT(means, 1e-4) << "the light is even, and this test sees no gradients";
}

// One sample, whose plane all nodes have: the picture is that of the plane through the light of a lamp at the sample
// and its central differences over two spacings, in double.
TEST_F(RadiancePlanesTest, APlaneIsThatOfCentralDifferences) {
    constexpr double kFog = 0.05, kSpacing = 0.5, kIntensity = 50; // 1/m, m, W/sr
    Scene scene;
    scene.medium.layout = Layout::none;
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0)};
    scene.fogs = {{.extinction = float(kFog), .albedo = glm::vec3(1)}};
    scene.lights = {{.type = kPoint, .position = glm::vec3(-0.2f), .shadows = false}};
    scene.lights[0].intensity = glm::vec3(float(kIntensity));
    // A black wall whose front is at z = -10. With 10 m around the lamp it is in a box from -20.8 to 9.8 m of each
    // axis, over which there are 64 nodes from -21 m on.
    scene.boxes = {{{-5.5f, -5.5f, -15.4f}, {30.6f, 30.6f, 10.8f}, 0, glm::vec3(0)}};
    const glm::dvec3 lamp(scene.lights[0].position);
    constexpr double kFirst = -21, kNodes = 64, kWall = -10;
    // Where the one sample of the one stratum is: jitterOf() in radiance_samples.comp of cell 0, for each axis.
    const glm::dvec3 sample(kFirst + (kNodes - 1) * kSpacing * 0.42858755588531494);
    scene.render.method = "gradients";
    scene.render.froxels = {.pixels = 1, .slices = 512};
    const Pose pose = lookAt({-6, -5, -4}, {-7.5f, -7, -10}, 0.3f);
    for (const char* quantity : {"radiance", "factor"}) {
        const bool factor = quantity == std::string_view("factor");
        scene.render.radiance = {
            .interpolation = "gradient", .quantity = quantity, .levels = 0, .spacing = float(kSpacing), .samples = 1};
        const auto falls = [&](glm::dvec3 x) { return kIntensity / glm::dot(x - lamp, x - lamp); };
        const auto light = [&](glm::dvec3 x) {
            return std::exp(-kFog * glm::distance(x, lamp)) * (factor ? 1 : falls(x));
        };
        glm::dvec3 gradient;
        for (int axis = 0; axis < 3; ++axis) {
            glm::dvec3 step(0);
            step[axis] = kSpacing;
            gradient[axis] = (light(sample + step) - light(sample - step)) / (2 * kSpacing);
        }
        // Radiance in a pixel of a plane of this gradient.
        const auto expected = [&](const Ray& ray, glm::dvec3 along) {
            constexpr int kSteps = 2000;
            const double end = (kWall - ray.eye.z) / ray.w.z, width = (end - ray.begin) / kSteps;
            double sum = 0;
            for (int i = 0; i < kSteps; ++i) {
                const double t = ray.begin + (i + 0.5) * width;
                const glm::dvec3 x = ray.at(t);
                const double plane = light(sample) + glm::dot(along, x - sample);
                sum += std::exp(-kFog * (t - ray.begin)) * plane * (factor ? falls(x) : 1) * width;
            }
            return sum * kFog / (4 * kPi);
        };
        const Picture picture = render(device(), scene, pose, kWidth, kHeight);
        double worst = 0,
               seen_part[3] = {}; // seen_part: what a thousandth of a derivative is in the pixel where it is most
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
                const double truth = expected(ray, gradient);
                worst = std::max(worst, std::abs(double(picture.at(x, y).r) / truth - 1));
                for (int axis = 0; axis < 3; ++axis) {
                    glm::dvec3 other = gradient;
                    other[axis] *= 1.001;
                    seen_part[axis] = std::max(seen_part[axis], std::abs(expected(ray, other) / truth - 1));
                }
            }
        std::printf("%-8s off by %.1e; a thousandth of each derivative is %.1e, %.1e, %.1e\n", quantity, worst,
                    seen_part[0], seen_part[1], seen_part[2]);
        // Of the factor a lamp's own fall is taken once in each of 512 slices.
        EXPECT_LE(worst, factor ? 4e-5 : 1e-5) << quantity;
        for (const double one : seen_part)
            EXPECT_GT(10 * one, factor ? 4e-5 : 1e-5) << quantity << ": this test sees no gradient";
    }
}

} // namespace
} // namespace brume::test::radiance_planes_test
