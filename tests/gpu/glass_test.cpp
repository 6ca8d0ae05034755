// Pictures through sheets of glass: laws that hold with every method, and the double-precision reference.
#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "server/effects/glass/glass_block.h"
#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::glass_test {
namespace {

const std::vector kOfParticles{"slabs", "grid", "isv", "sphere", "tiles", "froxels", "lit", "gradients", "march"};

class GlassTest : public JudgedTest {
protected:
    // Particles within 3 m of the origin, over a far plane, before an even sky.
    static Scene cloud(const std::string& method) {
        Scene scene = sceneOf(randomPoints(60, 4, 1.6f, 0.8f), 1.6f);
        scene.planes = {{-50, glm::vec3(0.3f)}};
        scene.sky = {.zenith = glm::vec3(0.6f, 0.5f, 0.4f), .horizon = glm::vec3(0.6f, 0.5f, 0.4f)};
        return with(std::move(scene), method);
    }
    // Fog that the eye is in, shafts of a box in it, and a lamp.
    static Scene foggy(const std::string& method) {
        Scene scene;
        scene.medium.layout = Layout::none;
        scene.planes = {{0, glm::vec3(0.3f)}};
        scene.boxes = {{{-1, 4, 0}, {1.5f, 1, 1.5f}, 0.4f, glm::vec3(0.5f)}};
        scene.lights = {Light{}, Light{.type = kPoint, .position = {2, 2, -1}, .intensity = {40, 20, 10}}};
        scene.lights[0].to_light = glm::normalize(glm::vec3(0.4f, 0.8f, 0.45f));
        scene.fogs = {{.extinction = 0.06f, .hi = 15}};
        return with(std::move(scene), method);
    }
    static Scene with(Scene scene, const std::string& method) {
        scene.render.method = method;
        // Of others than these every pixel is drawn through glass, whatever the rate is.
        scene.render.rate = method == "slabs" || method == "grid" ? 2 : 1;
        scene.render.slabs = 128, scene.render.grid.spacing = 0.5f;
        scene.render.froxels.pixels = 2, scene.render.march.samples = 64, scene.render.march.blur = "none";
        return scene;
    }
    static Picture seen(const Scene& scene, const Pose& pose = kEye) {
        return render(device(), scene, pose, kWidth, kHeight);
    }
    // The largest difference of two pictures' radiance, relative to their largest radiance.
    static float apart(const Picture& a, const Picture& b) {
        float difference = 0, largest = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i)
            for (int c = 0; c < 3; ++c) {
                difference = std::max(difference, std::abs(a.pixels[i][c] - b.pixels[i][c]));
                largest = std::max(largest, a.pixels[i][c]);
            }
        EXPECT_GT(largest, 0.1f);
        return difference / largest;
    }
    static void expectFinite(const Picture& picture) {
        for (const glm::vec4& pixel : picture.pixels) ASSERT_TRUE(std::isfinite(pixel.r + pixel.g + pixel.b + pixel.a));
    }
    // A sheet that fills all pictures of kEye, which looks along -Z.
    static Glass wall(float z, glm::vec3 transmittance) {
        return {.centre = {0, 0, z}, .width = 60, .height = 60, .transmittance = transmittance, .reflectance = 0};
    }

    static inline const Pose kEye = lookAt({0, 0, 9}, {0, 0, 0}, 0.6f);
    static constexpr float kRounding = 2e-6f;
    static constexpr uint32_t kSkyRows = 40; // of kEye's picture: above the plane
};

TEST_F(GlassTest, AClearSheetChangesNothing) {
    for (const char* method : some(kOfParticles)) {
        Scene scene = cloud(method);
        const Picture bare = seen(scene);
        scene.glasses = {{.centre = {0.3f, 0, 0.5f},
                          .width = 3,
                          .height = 2,
                          .yaw = 0.5f,
                          .pitch = 0.3f,
                          .transmittance = glm::vec3(1),
                          .reflectance = 0}};
        EXPECT_LT(apart(seen(scene), bare), kRounding) << method;
    }
}

// As a black box whose face is there. The light is ambient: a box throws shadows, a sheet none.
TEST_F(GlassTest, ABlackSheetIsAWall) {
    for (const char* method : some(kOfParticles)) {
        Scene sheet = cloud(method);
        sheet.lights.clear();
        sheet.sky.ambient = glm::vec3(0.5f, 0.6f, 0.7f);
        Scene box = sheet;
        sheet.glasses = {wall(0.4f, glm::vec3(0))};
        box.boxes = {{{0, 0, 0.395f}, {60, 60, 0.01f}, 0, glm::vec3(0)}};
        const Picture one = seen(sheet), other = seen(box);
        double off = 0, all = 0;
        for (size_t i = 0; i < one.pixels.size(); ++i) {
            const glm::dvec3 a(one.pixels[i]), b(other.pixels[i]);
            off += glm::dot(a - b, a - b), all += glm::dot(b, b);
        }
        std::printf("%-9s %.5f %%\n", method, 100 * std::sqrt(off / all));
        EXPECT_GT(all / double(one.pixels.size()), 1e-3) << method;
        // Rays of a field end at the box, but are looked up at the sheet. Others are alike but for the rounding of
        // depths.
        const bool field = std::string(method) == "slabs" || std::string(method) == "grid";
        EXPECT_LT(std::sqrt(off / all), field ? 2e-3 : 1e-4) << method;
    }
}

TEST_F(GlassTest, BeforeEverythingItTintsThePicture) {
    const glm::vec3 tint(0.9f, 0.5f, 0.1f);
    for (const char* method : some(kOfParticles)) {
        Scene scene = cloud(method);
        Picture bare = seen(scene);
        for (glm::vec4& pixel : bare.pixels) pixel *= glm::vec4(tint, 1);
        scene.glasses = {wall(8, tint)};
        const Picture tinted = seen(scene);
        EXPECT_LT(apart(tinted, bare), 1e-5f) << method;
        for (size_t i = 0; i < bare.pixels.size(); ++i)
            ASSERT_NEAR(tinted.pixels[i].a, bare.pixels[i].a, 1e-6f) << "the medium's own transmittance";
    }
}

// C + T t B in place of C + T B.
TEST_F(GlassTest, BehindEverythingItTintsTheBackground) {
    const glm::vec3 tint(0.9f, 0.5f, 0.1f);
    for (const char* method : some(kOfParticles)) {
        Scene scene = cloud(method);
        Picture bare = seen(scene);
        bare.pixels.resize(size_t(kSkyRows) * kWidth);
        for (glm::vec4& pixel : bare.pixels) pixel -= glm::vec4(pixel.a * (1.0f - tint) * scene.sky.zenith, 0);
        scene.glasses = {wall(-12, tint)};
        Picture tinted = seen(scene);
        tinted.pixels.resize(bare.pixels.size());
        EXPECT_LT(apart(tinted, bare), 1e-4f) << method;
    }
}

// Straight on it mirrors the sky behind the eye, which is as that before it.
TEST_F(GlassTest, MirrorsTheSky) {
    Scene scene = cloud("slabs");
    scene.medium.layout = Layout::none; // a scene without a medium
    scene.glasses = {wall(-1, {0.5f, 0.25f, 0})};
    scene.glasses[0].reflectance = 0.2f;
    const glm::vec4 middle = seen(scene).at(kWidth / 2, kSkyRows / 2);
    const glm::vec3 sky = scene.sky.zenith, expected = sky * (0.8f * scene.glasses[0].transmittance + 0.2f);
    EXPECT_LT(glm::distance(glm::vec3(middle), expected), 1e-4f);
}

TEST_F(GlassTest, TheFilesOrderDoesNotMatter) {
    for (const char* method : some(kOfParticles)) {
        Scene scene = cloud(method);
        scene.glasses = {{.centre = {0, 0, 1}, .width = 3, .height = 2, .yaw = 0.5f, .transmittance = {1, 0.5f, 0.2f}},
                         {.centre = {0, 0, -1}, .width = 4, .height = 3, .transmittance = {0.2f, 0.5f, 1}}};
        const Picture one = seen(scene);
        std::swap(scene.glasses[0], scene.glasses[1]);
        EXPECT_EQ(one.pixels, seen(scene).pixels) << method;
        scene.glasses.clear();
        EXPECT_GT(apart(one, seen(scene)), 0.05f) << method;
    }
}

// Sheets add nothing to a method's own error but what a cut through the medium adds.
TEST_F(GlassTest, SheetsInTheMedium) {
    for (const char* method : some({"slabs", "grid", "isv", "tiles"})) {
        Scene scene = cloud(method);
        const Error bare = errorOf(scene, kEye);
        scene.glasses = {
            {.centre = {-0.5f, 0, 1}, .width = 3, .height = 2, .yaw = 0.5f, .transmittance = {1, 0.5f, 0.2f}},
            {.centre = {0, 0.3f, 0}, .width = 2, .height = 5, .pitch = 0.4f, .transmittance = {0.3f, 1, 0.6f}},
            {.centre = {0, 0, -1}, .width = 4, .height = 3, .transmittance = {0.2f, 0.5f, 1}, .reflectance = 0.2f}};
        const Error with = errorOf(scene, kEye);
        std::printf("%-6s %.4f %%, without glass %.4f %%; worst pixel %.3f, %.3f %%\n", method, 100 * with.rmse,
                    100 * bare.rmse, 100 * with.worst, 100 * bare.worst);
        EXPECT_LT(with.rmse, 1.5 * bare.rmse + 1e-3) << method;
    }
}

TEST_F(GlassTest, InFog) {
    BRUME_WHOLE_LAYER_ONLY();
    const Pose inside = lookAt({0.5f, 2, 9}, {0, 2.2f, 0}, 0.9f);
    for (const char* method : some({"slabs", "froxels", "march"})) {
        Scene scene = foggy(method);
        const Error bare = errorOf(scene, inside);
        scene.glasses = {
            {.centre = {-1.5f, 1.5f, 3}, .width = 3, .height = 3, .yaw = 0.4f, .transmittance = {1, 0.5f, 0.2f}},
            {.centre = {1, 2, -3}, .width = 6, .height = 4, .transmittance = {0.2f, 0.5f, 1}, .reflectance = 0.1f}};
        const Error with = errorOf(scene, inside);
        std::printf("%-9s %.4f %%, without glass %.4f %%; worst pixel %.3f, %.3f %%\n", method, 100 * with.rmse,
                    100 * bare.rmse, 100 * with.worst, 100 * bare.worst);
        EXPECT_LT(with.rmse, 1.5 * bare.rmse + 2e-3) << method;
    }
}

TEST_F(GlassTest, InAColouredMediumAndFog) {
    BRUME_WHOLE_LAYER_ONLY();
    for (const char* method : {"slabs", "grid"}) {
        Scene scene = cloud(method);
        scene.medium.extinction_colour = {0.5f, 1, 0.1f};
        scene.fogs = {{.extinction = 0.05f, .hi = 15}};
        const Error bare = errorOf(scene, kEye);
        scene.glasses = {
            {.centre = {-0.5f, 0, 1}, .width = 3, .height = 2, .yaw = 0.5f, .transmittance = {1, 0.5f, 0.2f}},
            {.centre = {0, 0, -1}, .width = 4, .height = 3, .transmittance = {0.2f, 0.5f, 1}}};
        const Error with = errorOf(scene, kEye);
        std::printf("%-6s %.4f %%, without glass %.4f %%\n", method, 100 * with.rmse, 100 * bare.rmse);
        EXPECT_LT(with.rmse, 1.5 * bare.rmse + 2e-3) << method;
    }
}

TEST_F(GlassTest, OfAUnion) {
    Scene scene = cloud("tiles");
    scene.medium.model = kUnionMedium;
    scene.render.tiles.light = "path";
    for (const char* method : {"tiles", "sprites"}) {
        scene.render.method = method;
        scene.glasses.clear();
        const Picture bare = seen(scene);
        scene.glasses = {wall(0, glm::vec3(1))};
        EXPECT_LT(apart(seen(scene), bare), kRounding) << method;
        scene.glasses = {wall(0, glm::vec3(0))};
        const Picture black = seen(scene);
        expectFinite(black);
        for (size_t i = 0; i < bare.pixels.size(); ++i)
            for (int c = 0; c < 3; ++c) ASSERT_LE(black.pixels[i][c], bare.pixels[i][c] + 1e-5f) << method;
    }
}

// Seen along its plane, with the eye in it and beside it, and with the eye on a sheet.
TEST_F(GlassTest, EdgeOn) {
    for (const char* method : some(kOfParticles)) {
        Scene scene = cloud(method);
        const Picture bare = seen(scene);
        scene.glasses = {{.width = 40, .height = 3, .yaw = float(kPi) / 2, .transmittance = glm::vec3(0)},
                         {.width = 3, .height = 40, .pitch = float(kPi) / 2, .transmittance = glm::vec3(0)},
                         {.centre = {0, 0, 9}, .transmittance = glm::vec3(0)}};
        const Picture with = seen(scene);
        expectFinite(with);
        EXPECT_LT(apart(with, bare), kRounding) << method << ": the eye is in the planes of all";
        scene.glasses[0].centre.x = 1e-6f, scene.glasses[1].centre.y = -1e-6f;
        expectFinite(seen(scene));
    }
}

// Five sheets one behind the other: the fifth is not drawn.
TEST_F(GlassTest, TheNearestFourAreDrawn) {
    Scene scene = cloud("tiles");
    for (int i = 0; i < 4; ++i) scene.glasses.push_back(wall(3 - float(i), glm::vec3(0.8f, 0.9f, 1)));
    const Picture four = seen(scene);
    scene.glasses.insert(scene.glasses.begin(), wall(-2, glm::vec3(0)));
    EXPECT_EQ(four.pixels, seen(scene).pixels);
}

// Eyes of one submission, a probe of the second, and planes that are bytes.
TEST_F(GlassTest, SeveralEyesAndAProbe) {
    for (const char* method : {"slabs", "tiles"}) {
        Scene scene = cloud(method);
        scene.glasses = {
            {.centre = {-0.5f, 0, 1}, .width = 3, .height = 2, .yaw = 0.5f, .transmittance = {1, 0.5f, 0.2f}},
            {.centre = {0, 0, -1}, .width = 4, .height = 3, .transmittance = {0.2f, 0.5f, 1}}};
        const Simulation simulation(scene);
        Renderer renderer(device(), scene, simulation.capacity());
        Submission submission(device(), "glass");
        const EyeRequest eyes[]{{lookAt({5, 1, 8}, {0, 0, 0}, 0.6f), 100, 60}, {kEye, kWidth, kHeight}};
        submission.probe.eye = 1;
        submission.probe.pixels = {{80, 45}, {60, 30}, {3, 3}, {100, 50}};
        submitAndWait(renderer, submission, simulation, eyes);
        EXPECT_TRUE(submission.probe.drawn);
        const std::vector<glm::vec4> values(submission.probe.values().begin(), submission.probe.values().end());
        const Picture alone = seen(scene);
        for (size_t i = 0; i < values.size(); ++i)
            EXPECT_LT(glm::distance(values[i], alone.at(submission.probe.pixels[i].x, submission.probe.pixels[i].y)),
                      1e-5f)
                << method << ' ' << i;
    }
}

// A camera that goes slowly around: sheets that fill the picture cross each other in it, so that their order on a ray
// changes from pixel to pixel and from frame to frame. Frames that are a fifth as far apart go on more evenly: a pop
// would stay as large as it is.
TEST_F(GlassTest, SlowMotionDoesNotPop) {
    BRUME_WHOLE_LAYER_ONLY();
    constexpr int kFrames = 8;
    for (const char* method : some(kOfParticles)) {
        Scene scene = cloud(method);
        const auto roughest = [&](float degrees) {
            Stage stage(device(), scene, 60);
            std::vector<Picture> frames;
            for (int i = 0; i < kFrames; ++i) {
                const float angle = glm::radians(degrees * (float(i) - 3.5f));
                const Pose pose = lookAt({9 * std::sin(angle), 0, 9 * std::cos(angle)}, {0, 0, 0}, 0.6f);
                frames.push_back(stage.see(scene, pose, kWidth, kHeight));
            }
            float largest = 0, change = 0;
            for (int i = 1; i + 1 < kFrames; ++i)
                for (size_t p = 0; p < frames[0].pixels.size(); ++p)
                    for (int c = 0; c < 3; ++c) {
                        const float before = frames[size_t(i) - 1].pixels[p][c], now = frames[size_t(i)].pixels[p][c],
                                    after = frames[size_t(i) + 1].pixels[p][c];
                        largest = std::max(largest, now);
                        change = std::max(change, std::abs(before - 2 * now + after));
                    }
            return change / largest;
        };
        const float bare = roughest(0.1f);
        scene.glasses = {wall(0, {1, 0.5f, 0.2f}), wall(0, {0.3f, 1, 0.6f}), wall(0, {0.2f, 0.5f, 1})};
        scene.glasses[0].yaw = 0.7f, scene.glasses[1].yaw = -0.5f, scene.glasses[2].pitch = 0.6f;
        scene.glasses[0].centre.x = 2, scene.glasses[1].centre.x = -2; // which centre is nearer changes on the way
        const float coarse = roughest(0.5f), with = roughest(0.1f);
        std::printf("%-9s second difference %.5f of the brightest pixel, of larger steps %.5f, without glass %.5f\n",
                    method, double(with), double(coarse), double(bare));
        EXPECT_LT(with, 0.35f * coarse + 2e-4f) << method;
    }
}

// Steps of 4 cm through a sheet that is a little askew. Each pixel is tinted until the sheet is at the near plane, and
// never again. In the medium a clear sheet changes nothing in any frame.
TEST_F(GlassTest, AnEyeGoesThroughASheet) {
    const glm::vec3 tint(0.9f, 0.5f, 0.1f);
    for (const char* method : some(kOfParticles)) {
        const Scene bare = cloud(method);
        Scene before = bare, within = bare;
        before.glasses = {wall(9, tint)};
        within.glasses = {wall(0, glm::vec3(1))};
        before.glasses[0].yaw = within.glasses[0].yaw = 0.2f;
        Stage none(device(), bare, 60), tinting(device(), before, 60), clear(device(), within, 60);
        std::vector<bool> through(size_t(kWidth) * kHeight, false);
        size_t tinted = 0, mixed = 0, again = 0;
        for (int i = 0; i < 7; ++i) {
            const float ahead = 0.15f - 0.04f * float(i);
            const Pose outside = lookAt({0, 0, 9 + ahead}, {0, 0, 0}, 0.6f),
                       inside = lookAt({0, 0, ahead}, {0, 0, -9}, 0.6f);
            EXPECT_LT(apart(clear.see(within, inside, kWidth, kHeight), none.see(bare, inside, kWidth, kHeight)),
                      kRounding)
                << method << ' ' << i;
            const Picture without = none.see(bare, outside, kWidth, kHeight);
            const Picture with = tinting.see(before, outside, kWidth, kHeight);
            float largest = 0;
            for (const glm::vec4& pixel : without.pixels) largest = std::max({largest, pixel.r, pixel.g, pixel.b});
            for (size_t p = 0; p < through.size(); ++p) {
                const glm::vec3 plain(without.pixels[p]), seen(with.pixels[p]);
                const bool is_tinted = glm::distance(seen, tint * plain) < 1e-4f * largest;
                mixed += !is_tinted && glm::distance(seen, plain) > 1e-4f * largest;
                again += is_tinted && through[p];
                through[p] = !is_tinted;
                tinted += is_tinted;
            }
        }
        EXPECT_EQ(mixed, 0u) << method;
        EXPECT_EQ(again, 0u) << method;
        EXPECT_GT(tinted, through.size()) << method;
        EXPECT_EQ(std::ranges::count(through, false), 0) << method;
    }
}

TEST_F(GlassTest, ItsMemoryIsPredicted) {
    Scene scene = cloud("slabs");
    scene.glasses = {wall(0, glm::vec3(0.5f))};
    const Simulation simulation(scene);
    Renderer renderer(device(), scene, simulation.capacity());
    Submission submission(device(), "glass");
    const EyeRequest eye{kEye, 640, 360};
    submitAndWait(renderer, submission, simulation, {&eye, 1});
    const SceneFeatures features = featuresOf(scene, simulation.now());
    EXPECT_TRUE(features.glass);
    const uint64_t planes = PlaneLayout{640, 360, false}.bytes();
    EXPECT_GE(renderer.pictureBytes(), Renderer::pictureBytes({&eye, 1}, false, features));
    EXPECT_LE(renderer.pictureBytes(), Renderer::mostBytesOfPixel(features) * 640 * 360 + planes);
    renderer.giveBack();
    EXPECT_EQ(renderer.pictureBytes(), 0u);
}

// A sheet out of the picture costs no layer.
TEST_F(GlassTest, LayersOfAnEye) {
    const Frustum frustum = frustumOf(kEye, kWidth, kHeight);
    const auto layers = [&](std::initializer_list<glm::vec3> centres) {
        std::vector<Glass> glasses;
        for (const glm::vec3 centre : centres) glasses.push_back({.centre = centre});
        return glassLayers(glasses, kEye, frustum);
    };
    EXPECT_EQ(layers({}), 0u);
    EXPECT_EQ(layers({{0, 0, 0}}), 1u);
    EXPECT_EQ(layers({{0, 0, 0}, {3, 0, 0}, {0, 0, 8.9f}}), 3u);
    EXPECT_EQ(layers({{20, 0, 0}, {-20, 0, 0}, {0, 20, 0}, {0, -20, 0}, {0, 0, 10}}), 0u);
    EXPECT_EQ(layers({{0, 0, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}, {0, 0, 4}}), gpu::kGlassLayers);
}

} // namespace
} // namespace brume::test::glass_test
