// Views of how a picture is made: their names, their scales and colours, and their legends.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "common/view_names.h"
#include "server/net/picture_query.h"
#include "server/render/legend.h"
#include "shaders/shared/show_colours.h"

namespace brume {
namespace {

// Relative luminance (Rec. 709) of an sRGB colour, with a gamma of 2.2.
double luminance(glm::dvec3 srgb) {
    return 0.2126 * std::pow(srgb.r, 2.2) + 0.7152 * std::pow(srgb.g, 2.2) + 0.0722 * std::pow(srgb.b, 2.2);
}

TEST(View, EveryOneHasItsName) {
    ASSERT_EQ(std::size(kViewNames), gpu::kShows);
    EXPECT_EQ(viewNamed("picture"), gpu::kShowPicture);
    EXPECT_EQ(viewNamed("wasted"), gpu::kShowWasted);
    EXPECT_EQ(viewNamed("overdraw"), gpu::kShowOverdraw);
    EXPECT_EQ(viewNamed("particles"), gpu::kShowParticles);
    EXPECT_EQ(viewNamed("rays"), gpu::kShowRays);
    EXPECT_EQ(viewNamed("depth"), gpu::kShowDepth);
    EXPECT_EQ(viewNamed("shadow"), gpu::kShowShadow);
    EXPECT_EQ(viewNamed("light"), gpu::kShowLight);
    EXPECT_EQ(viewNamed("error"), gpu::kShowError);
    for (const std::string_view none : {"", "Depth", "depth ", "8", "pictures"}) EXPECT_FALSE(viewNamed(none)) << none;
}

// Matplotlib's own first, middle and last colours.
TEST(View, ColoursAreThoseOfTheMaps) {
    const auto expectNear = [](glm::dvec3 colour, glm::dvec3 expected) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(colour[c], expected[c], 0.035) << c;
    };
    expectNear(physics::viridis(0.0), {0.267, 0.005, 0.329});
    expectNear(physics::viridis(0.5), {0.128, 0.567, 0.551});
    expectNear(physics::viridis(1.0), {0.993, 0.906, 0.144});
    expectNear(physics::inferno(0.0), {0.001, 0.000, 0.014});
    expectNear(physics::inferno(0.5), {0.736, 0.216, 0.330});
    expectNear(physics::inferno(1.0), {0.988, 0.998, 0.645});
}

TEST(View, ScalesGrowBrighterWithTheirValue) {
    for (uint32_t show = 1; show < gpu::kShows; ++show) {
        SCOPED_TRACE(kViewNames[show]);
        EXPECT_EQ(physics::shownPart(show, physics::leastShown<double>(show)), 0);
        EXPECT_EQ(physics::shownPart(show, physics::mostShown<double>(show)), 1);
        EXPECT_EQ(physics::shownPart(show, 1e9), 1);
        EXPECT_EQ(physics::shownPart(show, 0.0), 0);
        if (show == gpu::kShowWasted) continue; // from green to red
        double last = 0;
        for (int i = 0; i <= 100; ++i) {
            const double now = luminance(physics::shownColour(show, i / 100.0));
            EXPECT_GT(now, last) << i;
            last = now;
        }
    }
    EXPECT_NEAR(physics::shownPart(gpu::kShowOverdraw, 10.0), 1.0 / 4, 1e-12);
    EXPECT_NEAR(physics::shownPart(gpu::kShowDepth, 0.1), 1.0 / 3, 1e-12);
    EXPECT_NEAR(physics::shownPart(gpu::kShowLight, 0.25), 0.25, 1e-12);
}

// The bar has the colours of the scale, each tick stands under its own, and every character has a glyph.
TEST(View, LegendsTellTheirScale) {
    for (uint32_t i = 0; i < kLegends; ++i) {
        const Legend& legend = legendOf(LegendOf(i));
        SCOPED_TRACE(std::string(legend.title));
        const LegendPicture picture = drawLegend(legend);
        ASSERT_EQ(picture.pixels.size(), size_t(picture.size.x) * picture.size.y);
        EXPECT_LT(picture.size.x, 320u); // fits into a small picture
        EXPECT_LT(picture.size.y, 48u);
        for (const char character : legend.title) {
            const std::string text(1, character);
            const LegendPicture one = drawLegend({legend.show, text, {}});
            const auto ink = std::ranges::count(one.pixels, 0xfff0f0f0u);
            EXPECT_EQ(ink > 0, character != ' ') << text;
        }
        for (const Legend::Tick& tick : legend.ticks) {
            const glm::vec3 rgb =
                255.0f * physics::shownColour(legend.show, physics::shownPart(legend.show, float(tick.value)));
            EXPECT_TRUE(std::ranges::any_of(picture.pixels, [&](uint32_t pixel) {
                return std::abs(float(pixel & 255) - rgb.r) < 3 && std::abs(float(pixel >> 8 & 255) - rgb.g) < 3 &&
                       std::abs(float(pixel >> 16 & 255) - rgb.b) < 3;
            })) << tick.text;
        }
    }
}

TEST(View, AQueryNamesOne) {
    const auto read = [](std::string_view query) {
        return net::readPictureQuery(query, {}, {{0, 2, 26}, {0, 0, 0}, 0.75f});
    };
    EXPECT_EQ(std::get<net::PictureQuery>(read("w=64")).request.show, gpu::kShowPicture);
    EXPECT_EQ(std::get<net::PictureQuery>(read("view=picture")).request.show, gpu::kShowPicture);
    EXPECT_EQ(std::get<net::PictureQuery>(read("w=64&view=light")).request.show, gpu::kShowLight);
    EXPECT_EQ(std::get<std::string>(read("view=lights")),
              "view must be one of picture wasted overdraw particles rays depth shadow light error");
    EXPECT_EQ(std::get<std::string>(read("w=640.5")), "w must be a whole number, 16 ... 3840");
    EXPECT_EQ(std::get<std::string>(read("quality=0.9")), "quality must be a whole number, 1 ... 100");
    EXPECT_EQ(std::get<std::string>(read("position=1,2,1e9")),
              "position must be x,y,z in metres, each -50000 ... 50000");
    EXPECT_EQ(std::get<net::PictureQuery>(read("show=1")).ignored, std::vector<std::string>{"show"});
}

} // namespace
} // namespace brume
