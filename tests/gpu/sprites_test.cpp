// Method sprites: pictures of a union medium, and the shadows that it throws on surfaces.
#include <cmath>
#include <filesystem>

#include <gtest/gtest.h>

#include "common/image.h"
#include "tests/gpu/judged.h"

namespace brume::test::sprites_test {
namespace {

class SpritesTest : public JudgedTest {
protected:
    static Scene tubes() {
        Scene scene = loadScene("server/scenes/tubes-union.toml");
        scene.lights[0].rotate = 0;
        scene.render.method = "sprites";
        return scene;
    }
    static Scene oneBall(glm::vec3 at = {0, 0, 0}) {
        Scene scene = sceneOf({{at, 1, 1}}, 1);
        scene.medium.model = kUnionMedium;
        scene.medium.union_radius = 1;
        scene.render.method = "sprites";
        scene.render.sprites.size = 1;
        scene.render.sprites.maps = "even";
        return scene;
    }
};

const Pose kBefore = lookAt({0, 0, 6}, {0, 0, 0}, 0.6f);

TEST_F(SpritesTest, AFurnaceIsEvenHoweverManySpritesThereAre) {
    Scene scene = tubes();
    scene.boxes.clear();
    scene.lights[0].irradiance = glm::vec3(0);
    scene.medium.albedo = scene.sky.ambient = scene.sky.zenith = scene.sky.horizon = glm::vec3(1);
    for (const char* maps : {"baked", "even"}) {
        scene.render.sprites.maps = maps;
        const Picture picture = render(device(), scene, lookAt({3, 6, 9}, {0, 4, 0}, 0.9f), 160, 90);
        float least = 1;
        for (const glm::vec4& pixel : picture.pixels) {
            EXPECT_NEAR(pixel.x, 1, 2e-6f);
            least = std::min(least, pixel.w);
        }
        EXPECT_LT(least, 0.02f) << "there is smoke in the picture";
    }
}

TEST_F(SpritesTest, OneEvenSpriteIsItsBall) {
    const Scene scene = oneBall();
    const Picture picture = render(device(), scene, kBefore, 161, 91);
    const float middle = std::exp(-2 * scene.medium.union_extinction);
    EXPECT_NEAR(picture.at(80, 45).w, middle, 2e-3f);
    // Light of the centre everywhere: half of the way through the ball.
    const float sun = std::exp(-scene.medium.union_extinction) / (4 * float(M_PI));
    EXPECT_NEAR(picture.at(80, 45).x, sun * (1 - middle), 1e-2f * sun);
    EXPECT_EQ(picture.at(2, 2), glm::vec4(0, 0, 0, 1));
}

TEST_F(SpritesTest, ASpriteComesThroughASurfaceSoftly) {
    Scene scene = oneBall();
    scene.medium.union_extinction = 0.8f;
    scene.planes = {{0, glm::vec3(0.5f)}};
    const Picture picture = render(device(), scene, lookAt({0, 1, 6}, {0, 0, 0}, 0.6f), 161, 91);
    float steepest = 0;
    for (uint32_t y = 1; y < 91; ++y)
        steepest = std::max(steepest, std::abs(picture.at(80, y).w - picture.at(80, y - 1).w));
    EXPECT_LT(steepest, 0.4f); // a picture that is cut at the ground: 0.8
    EXPECT_LT(picture.at(80, 40).w, 0.3f);
    EXPECT_EQ(picture.at(80, 88).w, 1) << "the ground hides what is behind it";
}

TEST_F(SpritesTest, PicturesOfASceneAreNearTheTruth) {
    Scene scene = tubes();
    scene.boxes.clear();
    scene.sky.zenith = scene.sky.horizon = glm::vec3(0);
    const Pose pose = lookAt({9, 8.5f, 13}, {0, 3, 0}, 0.8f);
    double last = 0;
    for (const char* maps : {"baked", "even"}) {
        scene.render.sprites.maps = maps;
        scene.render.sprites.size = std::string(maps) == "even" ? 1 : 1.3f;
        const Error error = errorOf(scene, pose);
        std::printf("%-6s %.1f %%, worst pixel %.0f %%\n", maps, 100 * error.rmse, 100 * error.worst);
        last = error.rmse;
    }
    EXPECT_LE(last, 0.25); // sprites are no medium: one light for each, and overlaps add up
}

TEST_F(SpritesTest, ABoxBelowShadowsNothingAndOneAboveAll) {
    Scene scene = oneBall();
    const auto seen = [&] { return render(device(), scene, kBefore, 33, 33).at(16, 16).x; };
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.25f, 1, 0.35f));
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0)};
    const float free = seen();
    scene.boxes = {{{0, -1.6f, 0}, {14, 0.2f, 14}, 0, glm::vec3(0)}};
    EXPECT_NEAR(seen(), free, 1e-3f * free);
    scene.boxes = {{{0, 3, 0}, {14, 0.2f, 14}, 0, glm::vec3(0)}};
    EXPECT_LT(seen(), 1e-3f * free);
}

// What the ground gets through the smoke. The exact path is the reference's; the thesis's modes are not.
TEST_F(SpritesTest, OnlyTheExactPathGivesSurfacesTheirLight) {
    Scene scene = tubes();
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0)};
    scene.boxes.clear();
    scene.planes = {{-0.1f, glm::vec3(0.5f)}};
    const Pose down = lookAt({0.1f, 30, 0.1f}, {0, 0, 0}, 0.7f);
    Simulation simulation(scene);
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    reference::World world = reference::worldOf(scene, particles);
    const reference::Stage stage(world, {.tolerance = 1e-5});
    for (const char* mode : {"exact", "nearest", "binary", "none"}) {
        scene.render.path.surfaces = mode;
        scene.medium.albedo = glm::vec3(0); // what is seen is the ground's light, dimmed by the smoke before it
        const Picture picture = render(device(), scene, down, 192, 108);
        const reference::Camera camera = reference::perspective(down, 192, 108, kNear);
        double sum = 0;
        int count = 0;
        for (uint32_t y = 1; y < 108; y += 3)
            for (uint32_t x = 1; x < 192; x += 3) {
                const reference::Ray ray = reference::rayThrough(camera, x + 0.5, y + 0.5);
                const double t = (-0.1 - ray.origin.y) / ray.direction.y;
                const reference::Ray toward{ray.at(t), glm::normalize(glm::dvec3(scene.lights[0].to_light))};
                std::vector<reference::Interval> parts;
                reference::insideUnion(world.balls, toward, parts);
                double path = 0;
                for (const reference::Interval part : parts) path += part.end - part.begin;
                const double truth = std::exp(-world.balls.sigma_t * path);
                if (path == 0 || picture.at(x, y).w < 1e-20f) continue; // beside the shadow; nothing is seen
                const double full = 0.5 / M_PI * double(scene.lights[0].irradiance.x) * toward.direction.y;
                const double got = double(picture.at(x, y).x) / (double(picture.at(x, y).w) * full);
                sum += (got - truth) * (got - truth), ++count;
            }
        const double rms = std::sqrt(sum / count);
        std::printf("%-8s RMS of the transmittance %.4f, of %d places in the shadow\n", mode, rms, count);
        EXPECT_GT(count, 50);
        if (std::string(mode) == "exact")
            EXPECT_LE(rms, 1e-4);
        else
            EXPECT_GE(rms, 0.05) << mode;
    }
}

TEST_F(SpritesTest, AViewersPictureIsTheSameAmongOthers) {
    const Scene scene = tubes();
    const Simulation simulation(scene);
    const Pose pose = lookAt({9, 8.5f, 13}, {0, 3, 0}, 0.8f);
    const auto planesOf = [&](std::vector<EyeRequest> eyes) {
        Renderer renderer(device(), scene, simulation.capacity());
        Submission submission(device(), "frame");
        submitAndWait(renderer, submission, simulation, eyes);
        const PictureView picture = submission.pictures().front();
        return std::vector<uint8_t>(picture.bytes, picture.bytes + picture.layout.bytes());
    };
    const EyeRequest one{pose, 160, 90};
    std::vector<EyeRequest> many{one};
    for (int i = 1; i < 5; ++i) many.push_back({lookAt({float(3 * i), 7, -9}, {0, 3, 0}, 0.8f), 96, 64});
    EXPECT_EQ(planesOf({one}), planesOf(many));
}

TEST_F(SpritesTest, OtherMethodsRefuseTheUnionAndSpritesRefuseTheSum) {
    Scene scene = tubes();
    scene.render.method = "slabs";
    EXPECT_THROW(render(device(), scene, kBefore, 32, 32), gpu::Error);
    scene = tubes();
    scene.medium.model = kSumMedium;
    EXPECT_THROW(render(device(), scene, kBefore, 32, 32), gpu::Error);
}

TEST_F(SpritesTest, LightMapsOfFilesAreDrawn) {
    const std::filesystem::path folder = testing::TempDir();
    Scene scene = oneBall();
    scene.render.sprites.maps = "files";
    scene.medium.sprite_maps = folder / "no-such-maps";
    EXPECT_THROW(render(device(), scene, kBefore, 32, 32), gpu::Error);
    // White light from the right, the top and the front, none from the other sides.
    scene.medium.sprite_maps = folder / "maps";
    writePng(folder / "maps-positive.png", 16, 8, std::vector<glm::u8vec3>(128, glm::u8vec3(255)));
    writePng(folder / "maps-negative.png", 16, 8, std::vector<glm::u8vec3>(128, glm::u8vec3(0)));
    scene.lights[0].to_light = {1, 0, 0};
    const glm::vec4 lit = render(device(), scene, kBefore, 33, 33).at(16, 16);
    scene.lights[0].to_light = {-1, 0, 0};
    const glm::vec4 dark = render(device(), scene, kBefore, 33, 33).at(16, 16);
    EXPECT_GT(lit.x, 1e-3f);
    EXPECT_EQ(dark.x, 0);
    EXPECT_EQ(lit.w, dark.w);
    writePng(folder / "maps-negative.png", 8, 8, std::vector<glm::u8vec3>(64, glm::u8vec3(0)));
    EXPECT_THROW(render(device(), scene, kBefore, 32, 32), gpu::Error);
}

} // namespace
} // namespace brume::test::sprites_test
