// Asymmetric frusta: what one sees is what a larger symmetric one sees there.
#include <algorithm>
#include <cmath>

#include "tests/gpu/closed_form.h"
#include "tests/gpu/quadrature.h"

namespace brume::test::frustum_test {
namespace {

constexpr uint32_t kWhole = 192, kTall = 160; // pixels of the symmetric picture

struct Crop {
    uint32_t x, y, width, height; // x and y in whole spacings of rays: both pictures have the same rays
};

class FrustumTest : public GpuTest {
protected:
    static Pose cropped(Pose pose, const Crop& crop) {
        const Frustum whole = frustumOf(pose, kWhole, kTall);
        const float pixel = 2 * whole.up / float(kTall);
        const auto tangent = [&](uint32_t at, float side) { return float(at) * pixel - side; };
        pose.frustum = {-tangent(crop.x, whole.left), tangent(crop.x + crop.width, whole.left),
                        -tangent(crop.y, whole.up), tangent(crop.y + crop.height, whole.up)};
        return pose;
    }

    // Radiance and transmittance of a pixel: the largest difference to the four beside it.
    static glm::dvec4 slope(const Picture& picture, uint32_t x, uint32_t y) {
        glm::dvec4 most(0);
        for (const glm::ivec2 step : {glm::ivec2(1, 0), glm::ivec2(-1, 0), glm::ivec2(0, 1), glm::ivec2(0, -1)}) {
            const glm::uvec2 there = glm::uvec2(glm::ivec2(x, y) + step);
            if (there.x < picture.width && there.y < picture.height)
                most = glm::max(most, glm::abs(glm::dvec4(picture.at(x, y) - picture.at(there.x, there.y))));
        }
        return most;
    }

    // Largest difference of radiance, as a part of the brightest, or of transmittance; `margin`: pixels at the sides
    // that do not count. `shift`: pixels by which what is drawn may be apart in the two pictures; what this explains
    // does not count.
    static double apart(const Picture& whole, const Picture& part, const Crop& crop, uint32_t margin,
                        double shift = 0) {
        double brightest = 1e-9, worst = 0, least = 1, most = 0;
        for (const glm::vec4& p : whole.pixels) brightest = std::max(brightest, double(std::max({p.r, p.g, p.b})));
        for (uint32_t y = margin; y < crop.height - margin; ++y)
            for (uint32_t x = margin; x < crop.width - margin; ++x) {
                const glm::dvec4 a(whole.at(crop.x + x, crop.y + y)), b(part.at(x, y));
                const glm::dvec4 d = glm::abs(a - b) - shift * slope(whole, crop.x + x, crop.y + y);
                EXPECT_TRUE(std::isfinite(d.r + d.g + d.b + d.a));
                worst = std::max({worst, std::max({d.r, d.g, d.b}) / brightest, d.a});
                least = std::min(least, b.a);
                most = std::max(most, b.a);
            }
        EXPECT_GT(most - least, 0.2) << "the crop shows something";
        return worst;
    }

    static Scene scene(const char* method, const char* quadrature) {
        Scene scene = sceneOf(randomPoints(120, 8, 2.5f, 0.6f, 11), 1.6f);
        scene.render.method = method;
        setQuadrature(scene.render, quadrature);
        scene.render.tiles.least_transmittance = 0;
        return scene;
    }
};

const Pose kPoses[] = {lookAt({0, 2, 16}, {0, 0, 0}, 0.9f), lookAt({0.5f, 0.3f, 2}, {0, 0, -1}, 1.6f)};
// Off the axis to one side; around it; none of it.
const Crop kCrops[] = {{0, 16, 96, 80}, {48, 64, 128, 80}, {112, 96, 80, 64}};

// The same rays to rounding. A place is rounded to 1e-6 m, tau changes by at most 6 per m along an edge of a proxy:
// 1e-4 is ten times what is left of that. A vertex of a proxy that lies midway between two of the device's steps is
// rounded to either, by the rounding of its place: 1e-4 allows for steps of 1/256 pixel.
TEST_F(FrustumTest, SeesWhatALargerSymmetricOneSees) {
    const std::pair<const char*, const char*> ways[] = {{"sphere", ""},      {"isv", "simpson"}, {"tiles", "hermite"},
                                                        {"tiles", "cached"}, {"slabs", ""},      {"grid", ""}};
    for (const auto& [method, quadrature] : ways)
        for (const Pose& pose : kPoses) {
            Scene with = scene(method, quadrature);
            with.render.rate = 1; // every pixel its own ray
            const double shift = method == std::string("isv") ? subpixel(device()) - 1.0 / 256 : 0;
            const Picture whole = plain().see(with, pose, kWhole, kTall);
            for (const Crop& crop : kCrops) {
                const Picture part = plain().see(with, cropped(pose, crop), crop.width, crop.height);
                EXPECT_LT(apart(whole, part, crop, 0, shift), 1e-4)
                    << method << ' ' << quadrature << ' ' << pose.position.z << ' ' << crop.x;
            }
        }
}

// Splines through few rays begin elsewhere: the coefficients' tails at the sides, 0.27^2 of a node's at the first
// pixel, are cut.
TEST_F(FrustumTest, SeesTheSameThroughFewRays) {
    for (const char* method : {"slabs", "grid"}) {
        Scene with = scene(method, "");
        with.render.rate = 8;
        const Picture whole = plain().see(with, kPoses[0], kWhole, kTall);
        for (const Crop& crop : kCrops) {
            const Picture part = plain().see(with, cropped(kPoses[0], crop), crop.width, crop.height);
            EXPECT_LT(apart(whole, part, crop, 24), 1e-3) << method << ' ' << crop.x;
            EXPECT_LT(apart(whole, part, crop, 0), 1e-2) << method << ' ' << crop.x;
        }
    }
}

// A plane, a box and a sphere behind the medium, and the sky, whose colour is the ray's.
TEST_F(FrustumTest, ObjectsAndSkyStandWhereTheyStood) {
    Scene with = scene("slabs", "");
    with.planes = {{-3, glm::vec3(0.5f)}};
    with.boxes = {{{1, 2, 0}, {3, 0.5f, 1}, 0.7f, glm::vec3(0.5f)}};
    with.spheres = {{{0, 0.5f, 3}, 0.9f, glm::vec3(0.5f)}};
    with.sky = {glm::vec3(0.3f, 0.5f, 0.9f), glm::vec3(0.7f), glm::vec3(0.2f)};
    with.render.rate = 1;
    Stage stage(device(), with, 600);
    const Picture whole = stage.see(with, kPoses[0], kWhole, kTall);
    for (const Crop& crop : kCrops) {
        const Picture part = stage.see(with, cropped(kPoses[0], crop), crop.width, crop.height);
        size_t far = 0; // at an edge a ray may fall on the other side by rounding
        for (uint32_t y = 0; y < crop.height; ++y)
            for (uint32_t x = 0; x < crop.width; ++x) {
                const glm::vec4 d = glm::abs(whole.at(crop.x + x, crop.y + y) - part.at(x, y));
                far += std::max({d.r, d.g, d.b}) > 1e-3f;
            }
        EXPECT_LE(far, 4u) << crop.x;
    }
}

} // namespace
} // namespace brume::test::frustum_test
