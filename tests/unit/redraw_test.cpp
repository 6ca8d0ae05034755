// Pictures redrawn from layers with depth, against what projection says of points in space.
#include <cmath>

#include <gtest/gtest.h>

#include "common/redraw.h"
#include "shaders/shared/depth_layers.h"

namespace brume {
namespace {

constexpr uint32_t kWidth = 64, kHeight = 48;

// A grey picture without layers, 1 m high in 1 m.
LayeredPicture grey() {
    LayeredPicture p;
    p.eye.position = {1, 2, 3};
    p.eye.frustum = {2.0f / 3, 2.0f / 3, 0.5f, 0.5f};
    p.width = kWidth, p.height = kHeight;
    p.picture.assign(size_t(kWidth) * kHeight, glm::u8vec3(100));
    return p;
}
uint8_t surfaceByte(float depth) {
    return uint8_t(std::lround(1 + gpu::depthByte(depth, gpu::kNearSurface, gpu::kFarSurface, 253)));
}
std::vector<glm::vec3> drawn(const LayeredPicture& p, glm::vec3 moved, float turned = 0) {
    Pose eye = p.eye;
    eye.position += moved;
    eye.orientation = glm::angleAxis(turned, glm::vec3(0, 1, 0));
    std::vector<glm::vec3> out(size_t(kWidth) * kHeight);
    Redraw(p).draw(eye, kWidth, kHeight, out);
    return out;
}
// Column of the brightest pixel of a row.
uint32_t brightest(const std::vector<glm::vec3>& picture, uint32_t y) {
    uint32_t best = 0;
    for (uint32_t x = 0; x < kWidth; ++x)
        if (picture[y * kWidth + x].g > picture[y * kWidth + best].g) best = x;
    return best;
}
float linearOf(uint8_t srgb) { return std::pow((float(srgb) / 255 + 0.055f) / 1.055f, 2.4f); }

// Four layers over a surface that make a picture of noise.
LayeredPicture layeredNoise(bool sky) {
    LayeredPicture p = grey();
    uint32_t bits = 1;
    const auto next = [&] { return uint8_t(40 + ((bits = bits * 1664525 + 1013904223) >> 24) / 2); };
    for (glm::u8vec3& pixel : p.picture) pixel = {next(), next(), next()};
    p.count = 4, p.columns = 18, p.rows = 14, p.spacing = 4, p.first = -3.5f, p.near = 2, p.far = 20;
    const size_t nodes = size_t(p.count) * p.columns * p.rows;
    for (size_t i = 0; i < nodes; ++i) {
        p.colours.emplace_back(next(), next(), next());
        p.transmittance.push_back(uint8_t(200 + next() / 8));
        p.depth.push_back(next());
    }
    if (sky)
        for (size_t i = 0; i < nodes / p.count; ++i) p.colours.emplace_back(next(), next(), next());
    else
        p.surface.assign(p.picture.size(), surfaceByte(30));
    return p;
}

TEST(Redraw, FromItsOwnPlaceAPictureIsWhatItWas) {
    for (const bool sky : {true, false}) {
        const LayeredPicture p = layeredNoise(sky);
        const std::vector<glm::vec3> out = drawn(p, glm::vec3(0));
        for (size_t i = 0; i < out.size(); ++i)
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(out[i][c], linearOf(p.picture[i][c]), 2e-4f) << sky << ' ' << i << ' ' << c;
    }
}

TEST(Redraw, WithoutLayersASurfaceMovesByItsDepth) {
    LayeredPicture p = grey();
    p.picture[20 * kWidth + 32] = glm::u8vec3(255);
    p.surface.assign(p.picture.size(), surfaceByte(4));
    const float depth = gpu::surfaceDepth(p.surface[0]);
    // One pixel is 1/48 of the depth.
    for (const int pixels : {-9, -3, 3, 9})
        EXPECT_EQ(brightest(drawn(p, {float(pixels) / 48 * depth, 0, 0}), 20), uint32_t(32 - pixels));
    p.surface.clear();
    EXPECT_EQ(brightest(drawn(p, {0.5f, 0, 0}), 20), 32u) << "the sky stays";
    EXPECT_EQ(brightest(drawn(p, {0, 0, 0}, std::atan(6.5f / 48)), 20), 39u) << "and turns";
}

// Two layers before the sky, each with one bright spot: both move by their own depths.
TEST(Redraw, EachLayerMovesByItsDepth) {
    LayeredPicture p = grey();
    p.count = 2, p.columns = 18, p.rows = 14, p.spacing = 4, p.first = -3.5f, p.near = 2, p.far = 8;
    const size_t nodes = size_t(p.columns) * p.rows;
    p.colours.assign(3 * nodes, glm::u8vec3(0));
    p.transmittance.assign(2 * nodes, 255);
    p.depth.assign(nodes, 0);       // 2 m
    p.depth.resize(2 * nodes, 255); // 8 m
    const auto put = [&](size_t layer, size_t column, size_t row) {
        p.colours[layer * nodes + row * p.columns + column] = glm::u8vec3(255);
        p.transmittance[layer * nodes + row * p.columns + column] = 0;
    };
    put(0, 8, 4), put(1, 8, 10); // at pixels (28, 12) and (28, 36)
    p.picture.assign(p.picture.size(), glm::u8vec3(0));
    for (const size_t row : {12, 36})
        for (size_t y = row - 3; y <= row + 3; ++y)
            for (size_t x = 25; x <= 31; ++x) p.picture[y * kWidth + x] = glm::u8vec3(200);
    const std::vector<glm::vec3> out = drawn(p, {0.5f, 0, 0});
    EXPECT_NEAR(float(brightest(out, 12)), 28 - 0.5f / 2 * 48, 3.1f);
    EXPECT_NEAR(float(brightest(out, 36)), 28 - 0.5f / 8 * 48, 3.1f);
}

// A near board before a far wall: from the side the wall comes out from behind it, and the board keeps its width.
TEST(Redraw, WhatWasHiddenIsFilledByWhatIsBehind) {
    LayeredPicture p = grey();
    p.surface.assign(p.picture.size(), surfaceByte(8));
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 24; x < 40; ++x) {
            p.picture[y * kWidth + x] = glm::u8vec3(250);
            p.surface[y * kWidth + x] = surfaceByte(2);
        }
    const std::vector<glm::vec3> out = drawn(p, {0.25f, 0, 0});
    const float board = linearOf(250), wall = linearOf(100);
    uint32_t wide = 0;
    for (uint32_t x = 0; x < kWidth; ++x) {
        const float value = out[20 * kWidth + x].g;
        wide += value > 0.5f * (board + wall);
        EXPECT_TRUE(std::abs(value - board) < 0.1f || std::abs(value - wall) < 0.1f) << x << ": nothing is stretched";
    }
    EXPECT_NEAR(wide, 16, 2);
}

TEST(Redraw, NothingIsSeenBehindThePicture) {
    for (const glm::vec3& pixel : drawn(layeredNoise(false), glm::vec3(0), 3.14159f)) ASSERT_EQ(pixel, glm::vec3(0));
}

} // namespace
} // namespace brume
