// Method slabs: what coarse rays make of pixels between them.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "tests/gpu/closed_form.h"
#include "tests/layer.h"

namespace brume::test::slabs_test {
namespace {

constexpr uint32_t kWidth = 101, kHeight = 67; // no multiple of anything

class SlabsTest : public GpuTest {
protected:
    static Scene soft() {
        Scene scene = sceneOf(randomPoints(60, 6, 9, 0.02f), 1.6f);
        scene.render.method = "slabs";
        scene.render.slabs = 32;
        scene.render.tiles.least_transmittance = 0;
        return scene;
    }
    // Relative RMSE of the optical depths that every `rate`th pixel's rays leave, against a ray for each.
    static double error(Stage& stage, Scene scene, uint32_t rate, const Pose& pose) {
        scene.render.rate = 1;
        const Picture fine = stage.see(scene, pose, kWidth, kHeight);
        scene.render.rate = rate;
        const Picture coarse = stage.see(scene, pose, kWidth, kHeight);
        double squares = 0, all = 0;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const double exact = -std::log(double(fine.at(x, y).a));
                squares += std::pow(-std::log(double(coarse.at(x, y).a)) - exact, 2);
                all += exact * exact;
            }
        EXPECT_GT(all, 0.01 * kWidth * kHeight);
        return std::sqrt(squares / all);
    }
};

constexpr double kDeviation = 0.1 * 9 * 1.6; // m
const Pose kPose = lookAt({3, 2, 34}, {0, 0, 0}, 0.35f);
double spacing(uint32_t rate) { return rate * 2 * std::tan(0.175) / kHeight * 34 / kDeviation; }

// A cubic B-spline through an isolated Gaussian errs by 0.013 q^4.5 along one axis for spacings q of 0.4 to 1
// deviations; along two by half as much again. What the cut-off of the particles' far tails leaves is the rest.
TEST_F(SlabsTest, RaysOfEveryRateErrByTheirSpacing) {
    Stage stage(device(), soft(), 60);
    for (const uint32_t rate : {2u, 3u, 4u, 6u, 7u, 8u}) {
        const double q = spacing(rate);
        EXPECT_LT(error(stage, soft(), rate, kPose), 0.02 * std::pow(q, 4.5) + 3e-4)
            << rate << " pixels, " << q << " deviations";
    }
    EXPECT_GT(error(stage, soft(), 16, kPose), 0.01) << "rays too far apart are not seen by this test";
}

// Fewer lanes, as other devices have them, fill fewer slabs or planes together. Of 3,000 particles in few tiles not all
// fit in one list.
TEST_F(SlabsTest, FewerLanesDrawTheSamePicture) {
    Scene scene = sceneOf(randomPoints(3000, 6, 3, 0.02f), 1.6f);
    scene.render.slabs = 32;
    scene.render.rate = 6;
    const Pose outside = lookAt({3, 2, 34}, {0, 0, 0}, 0.35f), inside = lookAt({1, 0.5f, 2}, {0, 0, 0}, 0.9f);
    for (const char* method : {"slabs", "grid"}) {
        scene.render.method = method;
        for (const uint32_t lanes : {4u, 1u}) {
            const gpu::Device few({.validation = true, .name = device().name(), .most_lanes = lanes});
            if (few.lanesTogether() == device().lanesTogether()) continue;
            for (const Pose& pose : {outside, inside}) {
                SCOPED_TRACE(testing::Message() << method << ", " << lanes << " lanes");
                const Picture usual = render(device(), scene, pose, kWidth, kHeight),
                              picture = render(few, scene, pose, kWidth, kHeight);
                float most = 0;
                for (const glm::vec4& pixel : usual.pixels) most = std::max({most, pixel.r, pixel.g, pixel.b});
                ASSERT_GT(most, 0.01f);
                for (size_t i = 0; i < usual.pixels.size(); ++i)
                    for (int c = 0; c < 4; ++c) ASSERT_NEAR(picture.pixels[i][c], usual.pixels[i][c], 3e-5f) << i;
            }
            EXPECT_EQ(few.validationMessages(), 0u);
        }
    }
}

// Slabs are added to by sheets, in tiles whose width grows with the distance. A particle is much smaller than the tiles
// of a sheet's last planes if it is small and close to the eye. It must not take away what else is there.
TEST_F(SlabsTest, AParticleCloseToTheEyeTakesNothingAwayFromThoseBehind) {
    std::vector<Point> points = {{{0, 0, -12}, 12, 0.05f}};
    const Scene behind = sceneOf(points, 1.6f);
    for (const float x : {-0.2f, 0.1f, 0.4f})
        for (const float y : {-0.3f, 0.05f, 0.2f}) points.push_back({{x, y, -0.6f}, 0.6f, 0.05f});
    Scene all = sceneOf(points, 1.6f);
    all.render = soft().render;
    Stage stage(device(), all, uint32_t(points.size())), bare(device(), behind, 1);
    for (const uint32_t slabs : {16u, 32u, 33u, 48u, 64u, 96u}) {
        all.render.slabs = slabs;
        all.render.rate = 6;
        const Pose pose = lookAt({0, 0, 0}, {0, 0, -1}, 1.2f);
        const Picture picture = stage.see(all, pose, kWidth, kHeight);
        Scene one = behind;
        one.render = all.render;
        one.render.slabs = 256;
        const Picture without = bare.see(one, pose, kWidth, kHeight);
        double worst = 0;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x)
                worst = std::max(worst, std::log(double(picture.at(x, y).a) / double(without.at(x, y).a)));
        EXPECT_LT(worst, 0.01) << slabs << " slabs";
    }
}

// Rays that end on a surface: a wall through the medium, all over the picture.
TEST_F(SlabsTest, RaysThatEndOnASurfaceErrNoMore) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = soft();
    scene.boxes = {{{0, 0, -51}, {400, 400, 100}, 0.1f, glm::vec3(0)}};
    Stage stage(device(), scene, 60);
    for (const uint32_t rate : {2u, 4u, 6u, 7u}) {
        const double q = spacing(rate);
        EXPECT_LT(error(stage, scene, rate, kPose), 0.02 * std::pow(q, 4.5) + 5e-4)
            << rate << " pixels, " << q << " deviations";
    }
}

// At the rim of a medium rays that meet it lie beside rays that meet nothing: what is scattered there is a share of
// what there is, and all that reaches the light's map is lit.
TEST_F(SlabsTest, TheRimOfAThinMediumIsAsBrightAsItIsDense) {
    Scene scene = sceneOf({thick({0, 0, 0}, 9, 0.02, 1.6f)}, 1.6f);
    scene.render = soft().render;
    scene.lights[0].irradiance = glm::vec3(float(4 * kPi));
    Stage stage(device(), scene, 1);
    for (const uint32_t rate : {4u, 6u, 8u}) {
        scene.render.rate = rate;
        const Picture picture = stage.see(scene, lookAt({0, 0, 34}, {0, 0, 0}, 0.5f), kWidth, kHeight);
        double least = 1e30, most = 0;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const double opacity = 1 - double(picture.at(x, y).a);
                if (opacity < 1e-4) continue; // float32's own rounding counts below
                least = std::min(least, double(picture.at(x, y).r) / opacity);
                most = std::max(most, double(picture.at(x, y).r) / opacity);
            }
        // Its own shadow takes 2 % at most.
        EXPECT_GT(least, 0.975) << rate;
        EXPECT_LT(most, 1.005) << rate;
    }
}

// Where shadows overlap the light is missing once, however many casters there are, in whatever order, and wherever
// others are. Casters hang above what is seen, others (more than one word's bits) throw their shadows beside the
// medium.
TEST_F(SlabsTest, ShadowsThatOverlapCountOnce) {
    Scene once = soft();
    once.render.shading = 1; // every pixel: others may take one from those around it
    once.lights[0].to_light = glm::normalize(glm::vec3(0.2f, 1, 0.1f));
    const Scene lit = once;
    once.boxes = {{{-3, 30, 0}, {4, 2, 9}, 0.4f, glm::vec3(0)}};
    once.spheres = {{{4, 32, 1}, 3, glm::vec3(0)}, {{4.5f, 28, 1}, 3, glm::vec3(0)}};
    Scene often = lit;
    for (int i = 0; i < 40; ++i) often.boxes.push_back({{300 + 5 * i, 40, 200}, {4, 4, 4}, 0, glm::vec3(0)});
    for (int i = 0; i < 4; ++i) often.boxes.push_back(once.boxes[0]);
    often.spheres = {once.spheres[1], once.spheres[0], once.spheres[1], once.spheres[0]};
    Stage with_few(device(), once, 60), with_many(device(), often, 60), without(device(), lit, 60);
    for (const uint32_t rate : {6u, 8u}) {
        SCOPED_TRACE(rate);
        const auto see = [&](Stage& stage, Scene scene) {
            scene.render.rate = rate;
            return stage.see(scene, kPose, kWidth, kHeight);
        };
        const Picture few = see(with_few, once), many = see(with_many, often), none = see(without, lit);
        double missing = 0, all = 0;
        for (size_t i = 0; i < few.pixels.size(); ++i) {
            ASSERT_NEAR(few.pixels[i].r, many.pixels[i].r, 2e-6f + 1e-5f * few.pixels[i].r) << i;
            missing += double(none.pixels[i].r) - double(few.pixels[i].r);
            all += double(none.pixels[i].r);
        }
        EXPECT_GT(missing, 0.1 * all) << "this test sees no shadow";
    }
}

// Pictures of one submission may each have their own rate: they are what they are alone.
TEST_F(SlabsTest, APictureMayHaveItsOwnRate) {
    const Pose pose = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);
    const EyeRequest large{pose, 320, 180}, small{pose, 160, 90}, fine{pose, 160, 90, false, 2};
    for (const char* name : {"cloud", "props"})
        for (const char* method : {"slabs", "grid"}) {
            SCOPED_TRACE(std::string(name) + ", " + method);
            Scene scene = loadScene("server/scenes/" + std::string(name) + ".toml");
            scene.render.method = method;
            scene.render.shadow_size = 64;
            scene.render.slabs = 24;
            const auto planesOf = [&](uint32_t rate, std::span<const EyeRequest> eyes) {
                scene.render.rate = rate;
                const Simulation simulation(scene);
                Renderer renderer(device(), scene, simulation.capacity());
                Submission submission(device(), "own rate");
                submitAndWait(renderer, submission, simulation, eyes);
                std::vector<std::vector<uint8_t>> all;
                for (const PictureView& picture : submission.pictures())
                    all.emplace_back(picture.bytes, picture.bytes + picture.layout.bytes());
                return all;
            };
            const auto together = planesOf(8, std::array{large, fine, small});
            EXPECT_EQ(together[0], planesOf(8, {&large, 1})[0]);
            EXPECT_EQ(together[1], planesOf(2, {&small, 1})[0]);
            EXPECT_EQ(together[2], planesOf(8, {&small, 1})[0]);
            EXPECT_NE(together[1], together[2]);
        }
}

// Of a ray only the faces are written that pixels read: what the buffer held before must show nowhere, be it at edges,
// on a ground through the medium, in shadows, or where the near plane cuts the ground.
TEST_F(SlabsTest, WhatWasSeenBeforeLeavesNoTraceAtObjects) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene ground = soft();
    ground.lights[0].to_light = glm::normalize(glm::vec3(0.2f, 1, 0.1f));
    ground.planes = {{-1, glm::vec3(0.5f)}};
    Scene props = ground;
    props.boxes = {{{2, 0, 3}, {0.4f, 12, 0.4f}, 0.3f, glm::vec3(0.5f)}};
    props.spheres = {{{-3, 1, 0}, 1.5f, glm::vec3(0.5f)}};
    const Pose before[] = {lookAt({-20, 6, 22}, {0, 0, 0}, 0.6f), lookAt({14, -0.5f, 3}, {0, 0, 0}, 0.9f)};
    const Pose poses[] = {lookAt({3, 2, 34}, {0, 0, 0}, 0.35f), lookAt({2, 0.5f, 9}, {0, -1, 0}, 1.2f),
                          lookAt({0, -0.99f, 4}, {0, -2, 0}, 1.2f)};
    constexpr uint32_t kWide = 3 * kWidth, kHigh = 3 * kHeight;
    for (Scene scene : {ground, props})
        for (const char* method : {"slabs", "grid"}) {
            scene.render.method = method;
            Stage one(device(), scene, 60), other(device(), scene, 60);
            for (const uint32_t rate : {1u, 3u, 8u})
                for (size_t p = 0; p < std::size(poses); ++p) {
                    SCOPED_TRACE(std::string(method) + ", rate " + std::to_string(rate) + ", pose " +
                                 std::to_string(p) + (scene.boxes.empty() ? ", ground" : ", props"));
                    scene.render.rate = rate;
                    one.see(scene, before[0], kWide, kHigh);
                    other.see(scene, before[1], kWide, kHigh);
                    EXPECT_TRUE(one.see(scene, poses[p], kWide, kHigh).pixels ==
                                other.see(scene, poses[p], kWide, kHigh).pixels);
                }
        }
}

// Of scenes with objects some rates are made in wider blocks: every pixel is still where it belongs, up to the right
// edge.
TEST_F(SlabsTest, BlocksOfEveryWidthShowTheSamePicture) {
    Scene scene = loadScene("server/scenes/props.toml");
    scene.render.method = "slabs";
    scene.render.shadow_size = 64;
    constexpr uint32_t kWidths[] = {641, 169, 23};
    std::map<uint32_t, std::vector<uint8_t>> before; // by the width
    for (const uint32_t rate : {4u, 3u, 6u}) {
        scene.render.rate = rate;
        const Simulation simulation(scene);
        Renderer renderer(device(), scene, simulation.capacity());
        Submission submission(device(), "blocks");
        for (const uint32_t width : kWidths) {
            const EyeRequest eye{lookAt({-5, 7, 27}, {-0.5f, 4.8f, 0}, 0.8f), width, 361};
            submitAndWait(renderer, submission, simulation, {&eye, 1});
            const PictureView picture = submission.pictures()[0];
            const std::vector<uint8_t> now(picture.bytes, picture.bytes + picture.layout.bytes());
            std::vector<uint8_t>& first = before.try_emplace(width, now).first->second;
            ASSERT_EQ(now.size(), first.size());
            for (uint32_t block = 0; block < width; block += 8) {
                double off = 0;
                const uint32_t columns = std::min(8u, width - block);
                for (uint32_t y = 0; y < eye.height; ++y)
                    for (uint32_t x = block; x < block + columns; ++x) {
                        const size_t at = size_t(y) * picture.layout.lumaStride() + x;
                        off += std::abs(int(first[at]) - int(now[at]));
                    }
                ASSERT_LT(off / (columns * eye.height), 1.5) << width << ' ' << rate << ' ' << block; // levels
            }
        }
    }
}

} // namespace
} // namespace brume::test::slabs_test
