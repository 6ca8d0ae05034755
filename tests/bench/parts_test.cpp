// The error of sprites taken apart: between the reference's union and the device's picture nothing is left over.
#include "tools/bench/parts.h"

#include <cmath>
#include <numbers>

#include "tests/bench/on_device.h"
#include "tools/bench/ground_error.h"
#include "tools/bench/truth.h"

namespace brume::bench::parts_test {
namespace {

constexpr const char* kScene = "tools/bench/scenes/tubes-alone.toml";
constexpr glm::uvec2 kSize(90, 90);
constexpr uint32_t kEvery = 5;

class Parts : public OnDevice {
protected:
    static SpriteParts of(const Stage& stage, const methods::sprites::LightMaps& maps) {
        const Medium& medium = stage.simulation().now().medium;
        return {reference::unionOf(stage.particles(), double(medium.union_radius), double(medium.union_extinction),
                                   glm::dvec3(1)),
                stage.simulation().now().light.to_light,
                reference::perspective(stage.pose(), int(kSize.x), int(kSize.y)),
                double(stage.simulation().now().render.sprites.size), maps};
    }
    static double lightOf(const Stage& stage) {
        const SceneNow& now = stage.simulation().now();
        return double(now.medium.albedo.r * now.light.irradiance.r) / (4 * std::numbers::pi);
    }
};

TEST_F(Parts, TheUnionIsTheReferences) {
    Stage stage(device(), {.scene = kScene, .set = {"medium.count=250", "medium.union_radius=0.1731"}});
    const glm::uvec2 size = thinned(kSize, 9);
    const SpriteParts sprites = of(stage, methods::sprites::bakedMaps());
    Truth truth(folder("parts"));
    const RadianceImage exact = truth.of(stage, stage.pose(), kSize, 9);
    double squares = 0, all = 0;
    int count = 0;
    for (uint32_t y = 0; y < size.y; ++y)
        for (uint32_t x = 0; x < size.x; ++x) {
            const size_t at = size_t(y) * size.x + x;
            const SpriteParts::Seen seen = sprites.at(glm::uvec2(x, y) * 9u + 4u, {});
            EXPECT_NEAR(seen.transmittance, double(exact.transmittance[at]), 1e-6) << x << ", " << y;
            const double r = double(exact.radiance[at].r) / lightOf(stage);
            squares += (seen.light - r) * (seen.light - r), all += r * r, count += seen.transmittance < 0.999;
        }
    EXPECT_GT(count, 15);
    EXPECT_LT(std::sqrt(squares / all), 4e-5); // panels of 0.04 radii leave 2e-5 at the light's kinks
}

TEST_F(Parts, AddUpAndEndAtTheDevicesPicture) {
    for (const char* maps : {"baked", "even"}) {
        Case wanted{.scene = kScene, .set = {std::string("render.sprites.maps=") + maps, "render.sprites.size=1.2"}};
        Stage stage(device(), wanted);
        const methods::sprites::LightMaps all =
            std::string(maps) == "even" ? methods::sprites::evenMaps() : methods::sprites::bakedMaps();
        const RadianceImage picture = stage.picture(stage.pose(), kSize);
        const PartsOfError parts = partsOfError(of(stage, all), {kSize, kEvery, picture, lightOf(stage)});
        EXPECT_GT(parts.pixels, 50u);
        // The device has float32. Even maps end with a step, and places of corners are rounded to parts of a pixel.
        EXPECT_LT(parts.drawn, std::string(maps) == "even" ? 5e-3 : 1e-5) << maps;
        EXPECT_LT(parts.closure, 1e-12);
        EXPECT_GT(parts.whole, 0.05);
        double sum = 0;
        for (size_t i = 0; i < parts.products.size(); ++i) {
            for (const double product : parts.products[i]) sum += product;
            EXPECT_NEAR(std::sqrt(parts.products[i][i]), parts.parts[i].step, 1e-12);
        }
        EXPECT_NEAR(std::sqrt(sum), parts.whole, 1e-9);
        EXPECT_EQ(parts.parts.front().alone, parts.parts.front().step);
        if (std::string(maps) == "even") {
            EXPECT_EQ(parts.parts.back().step, 0);
        }
    }
}

// One ball has no overlap.
TEST_F(Parts, OneBallErrsByItsLightAlone) {
    const SpriteParts one({{{{0, 0, 0}, 1}}, 0.5, glm::dvec3(1)}, {0, 0.6, 0.8},
                          reference::perspective(lookAt({0, 0, 6}, {0, 0, 0}, 0.4f), 33, 33), 1,
                          methods::sprites::bakedMaps());
    const glm::uvec2 middle(16, 16);
    const SpriteParts::Seen truth = one.at(middle, {}), over = one.at(middle, {.over = true});
    EXPECT_EQ(truth.light, over.light);
    EXPECT_NEAR(truth.transmittance, std::exp(-1.0), 1e-12);
    const SpriteParts::Seen lit = one.at(middle, {.one_light = true});
    EXPECT_NEAR(lit.light, std::exp(-0.5) * (1 - std::exp(-1.0)), 1e-12);
    const SpriteParts::Seen mean = one.at(middle, {.depth = SpriteWay::Depth::mean});
    EXPECT_NEAR(mean.transmittance, std::exp(-0.5 * 4 / 3), 1e-12);
    EXPECT_EQ(one.at({0, 0}, {}).transmittance, 1);
}

TEST_F(Parts, TheGroundsShadowIsExactByTheExactPathAlone) {
    Case wanted{.scene = "tubes-union", .set = {"render.method=sprites", "light.rotate=0"}};
    const GroundError exact = groundError(device(), wanted, kSize, 0);
    EXPECT_GT(exact.places, 500);
    EXPECT_LT(exact.rms, 1e-4);
    wanted.set.emplace_back("render.path.surfaces=nearest");
    const GroundError nearest = groundError(device(), wanted, kSize, 0);
    EXPECT_EQ(nearest.places, exact.places);
    EXPECT_GT(nearest.rms, 0.05);
    wanted.set.back() = "render.path.surfaces=none";
    EXPECT_GT(groundError(device(), wanted, kSize, 0).bias, 0.2);
}

} // namespace
} // namespace brume::bench::parts_test
