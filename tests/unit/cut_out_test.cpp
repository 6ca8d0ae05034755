// Pictures without their sky: over the sky they are what they were.
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>

#include <gtest/gtest.h>
#include <png.h>

#include "common/image.h"
#include "server/encode/cut_out.h"

namespace brume::cut_out_test {
namespace {

// Medium, surfaces, smoothed edges of dark and of bright ones, and clear sky, by chance.
RawPicture somePicture(bool filmic) {
    RawPicture picture{.width = 61, .height = 37};
    picture.eye = lookAt({1, 2, 3}, {4, 2.5f, -6}, 0.9f);
    picture.exposure = 1.5f;
    picture.filmic = filmic;
    std::mt19937 random(7);
    std::uniform_real_distribution<float> part(0, 1);
    for (uint32_t y = 0; y < picture.height; ++y)
        for (uint32_t x = 0; x < picture.width; ++x) {
            const glm::vec3 sky = skyBehind(picture, x, y);
            const glm::vec3 own(part(random), part(random), part(random));
            const int kind = int(4 * part(random));
            const float through = kind == 0 ? 1 : part(random);
            float depth = 1e30f;
            glm::vec3 whole = sky * through + (kind == 0 ? glm::vec3(0) : 3.0f * own * (1 - through));
            if (kind == 2) whole = own, depth = 5;
            if (kind == 3) whole = glm::mix(sky, 2.0f * own * own, part(random)); // a pixel that an edge crosses
            picture.radiance.emplace_back(whole, kind == 3 ? 1 : through);
            picture.view_depth.push_back(depth);
        }
    return picture;
}

TEST(CutOut, OverTheSkysRadianceIsThePicture) {
    const RawPicture picture = somePicture(true);
    const auto cut = premultiplied(picture);
    ASSERT_EQ(cut.size(), picture.radiance.size());
    size_t surfaces = 0, clear = 0;
    for (uint32_t y = 0, i = 0; y < picture.height; ++y)
        for (uint32_t x = 0; x < picture.width; ++x, ++i) {
            const glm::vec3 sky = skyBehind(picture, x, y), again = glm::vec3(cut[i]) + (1 - cut[i].a) * sky;
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(again[c], picture.radiance[i][c], 1e-6f);
                EXPECT_GE(cut[i][c], 0);
            }
            EXPECT_GE(cut[i].a, 0);
            EXPECT_LE(cut[i].a, 1);
            surfaces += picture.view_depth[i] < kNoSurface && cut[i].a == 1;
            clear += cut[i].a < 1e-6f;
        }
    EXPECT_GT(surfaces, 300u);
    EXPECT_GT(clear, 300u);
}

TEST(CutOut, OverTheShownSkyIsTheShownPicture) {
    for (const bool filmic : {false, true}) {
        const RawPicture picture = somePicture(filmic);
        const auto cut = straight(picture);
        for (uint32_t y = 0, i = 0; y < picture.height; ++y)
            for (uint32_t x = 0; x < picture.width; ++x, ++i) {
                const glm::vec3 sky = shown(picture, skyBehind(picture, x, y));
                const glm::vec3 whole = shown(picture, glm::vec3(picture.radiance[i]));
                const glm::vec3 again = cut[i].a * glm::vec3(cut[i]) + (1 - cut[i].a) * sky;
                for (int c = 0; c < 3; ++c) {
                    EXPECT_NEAR(again[c], whole[c], 2e-6f) << "filmic " << filmic;
                    EXPECT_GE(cut[i][c], 0);
                    EXPECT_LE(cut[i][c], 1);
                }
            }
    }
}

// The alpha of thin medium in front of the sky is 1 - transmittance: nothing takes more.
TEST(CutOut, HasTheMediumsOwnAlpha) {
    RawPicture picture{.width = 2, .height = 1};
    const glm::vec3 sky = skyBehind(picture, 0, 0);
    picture.radiance = {{0.25f * sky + glm::vec3(0.5f), 0.25f}, {0.75f * sky + glm::vec3(0.1f), 0.75f}};
    EXPECT_NEAR(premultiplied(picture)[0].a, 0.75f, 1e-6f);
    EXPECT_NEAR(premultiplied(picture)[1].a, 0.25f, 1e-6f);
    EXPECT_NEAR(straight(picture)[1].a, 0.25f, 1e-6f);
    picture.view_depth = {1e30f, 12};
    EXPECT_EQ(premultiplied(picture)[1].a, 1);
}

TEST(CutOut, IsReadBackFromItsFiles) {
    const RawPicture picture = somePicture(true);
    const auto exr = cutOutExr(picture), png = cutOutPng(picture);
    const auto file = std::filesystem::path(testing::TempDir()) / "cut_out.exr";
    std::ofstream(file, std::ios::binary).write(reinterpret_cast<const char*>(exr.data()), std::streamsize(exr.size()));
    const RadianceImage read = readExr(file); // by OpenEXR's own library
    ASSERT_EQ(read.width, 61);
    ASSERT_EQ(read.height, 37);
    const auto linear = premultiplied(picture), plain = straight(picture);
    for (size_t i = 0; i < linear.size(); ++i)
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(read.radiance[i][c], linear[i][c], 5e-4f * linear[i][c] + 1e-7f);

    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    ASSERT_NE(png_image_begin_read_from_memory(&image, png.data(), png.size()), 0);
    EXPECT_EQ(image.format, uint32_t(PNG_FORMAT_RGBA));
    std::vector<uint8_t> pixels(PNG_IMAGE_SIZE(image));
    ASSERT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0);
    for (size_t i = 0; i < plain.size(); ++i)
        for (int c = 0; c < 4; ++c) EXPECT_EQ(pixels[4 * i + size_t(c)], std::lround(255 * plain[i][c]));
}

} // namespace
} // namespace brume::cut_out_test
