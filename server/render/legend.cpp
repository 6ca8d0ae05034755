#include "server/render/legend.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shaders/shared/show_colours.h"

namespace brume {
namespace {

constexpr uint32_t kAdvance = 6, kHeight = 7; // pixels of a character
constexpr uint32_t kMargin = 5, kBarWidth = 184, kBarHeight = 8, kGap = 4;
constexpr uint32_t kInk = 0xfff0f0f0, kPaper = 0xd0181410; // opacity, B, G, R

// Rows of five pixels from the top down; the left one is bit 4.
struct Glyph {
    char character;
    std::array<uint8_t, kHeight> rows;
};
constexpr Glyph kFont[]{
    {'0', {0x0e, 0x11, 0x13, 0x15, 0x19, 0x11, 0x0e}}, {'1', {0x04, 0x0c, 0x04, 0x04, 0x04, 0x04, 0x0e}},
    {'2', {0x0e, 0x11, 0x01, 0x02, 0x04, 0x08, 0x1f}}, {'3', {0x1f, 0x02, 0x04, 0x02, 0x01, 0x11, 0x0e}},
    {'4', {0x02, 0x06, 0x0a, 0x12, 0x1f, 0x02, 0x02}}, {'5', {0x1f, 0x10, 0x1e, 0x01, 0x01, 0x11, 0x0e}},
    {'6', {0x06, 0x08, 0x10, 0x1e, 0x11, 0x11, 0x0e}}, {'7', {0x1f, 0x01, 0x02, 0x04, 0x08, 0x08, 0x08}},
    {'8', {0x0e, 0x11, 0x11, 0x0e, 0x11, 0x11, 0x0e}}, {'9', {0x0e, 0x11, 0x11, 0x0f, 0x01, 0x02, 0x0c}},
    {'A', {0x0e, 0x11, 0x11, 0x11, 0x1f, 0x11, 0x11}}, {'B', {0x1e, 0x11, 0x11, 0x1e, 0x11, 0x11, 0x1e}},
    {'C', {0x0e, 0x11, 0x10, 0x10, 0x10, 0x11, 0x0e}}, {'D', {0x1c, 0x12, 0x11, 0x11, 0x11, 0x12, 0x1c}},
    {'E', {0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x1f}}, {'F', {0x1f, 0x10, 0x10, 0x1e, 0x10, 0x10, 0x10}},
    {'G', {0x0e, 0x11, 0x10, 0x17, 0x11, 0x11, 0x0f}}, {'H', {0x11, 0x11, 0x11, 0x1f, 0x11, 0x11, 0x11}},
    {'I', {0x0e, 0x04, 0x04, 0x04, 0x04, 0x04, 0x0e}}, {'J', {0x07, 0x02, 0x02, 0x02, 0x02, 0x12, 0x0c}},
    {'K', {0x11, 0x12, 0x14, 0x18, 0x14, 0x12, 0x11}}, {'L', {0x10, 0x10, 0x10, 0x10, 0x10, 0x10, 0x1f}},
    {'M', {0x11, 0x1b, 0x15, 0x15, 0x11, 0x11, 0x11}}, {'N', {0x11, 0x11, 0x19, 0x15, 0x13, 0x11, 0x11}},
    {'O', {0x0e, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e}}, {'P', {0x1e, 0x11, 0x11, 0x1e, 0x10, 0x10, 0x10}},
    {'Q', {0x0e, 0x11, 0x11, 0x11, 0x15, 0x12, 0x0d}}, {'R', {0x1e, 0x11, 0x11, 0x1e, 0x14, 0x12, 0x11}},
    {'S', {0x0f, 0x10, 0x10, 0x0e, 0x01, 0x01, 0x1e}}, {'T', {0x1f, 0x04, 0x04, 0x04, 0x04, 0x04, 0x04}},
    {'U', {0x11, 0x11, 0x11, 0x11, 0x11, 0x11, 0x0e}}, {'V', {0x11, 0x11, 0x11, 0x11, 0x11, 0x0a, 0x04}},
    {'W', {0x11, 0x11, 0x11, 0x15, 0x15, 0x15, 0x0a}}, {'X', {0x11, 0x11, 0x0a, 0x04, 0x0a, 0x11, 0x11}},
    {'Y', {0x11, 0x11, 0x11, 0x0a, 0x04, 0x04, 0x04}}, {'Z', {0x1f, 0x01, 0x02, 0x04, 0x08, 0x10, 0x1f}},
    {'.', {0x00, 0x00, 0x00, 0x00, 0x00, 0x0c, 0x0c}}, {',', {0x00, 0x00, 0x00, 0x00, 0x0c, 0x04, 0x08}},
    {':', {0x00, 0x0c, 0x0c, 0x00, 0x0c, 0x0c, 0x00}}, {'%', {0x18, 0x19, 0x02, 0x04, 0x08, 0x13, 0x03}},
    {'-', {0x00, 0x00, 0x00, 0x1f, 0x00, 0x00, 0x00}}, {'\'', {0x04, 0x04, 0x08, 0x00, 0x00, 0x00, 0x00}},
};

constexpr Legend::Tick kHalves[]{{0, "DRAWN"}, {0.5, "HALF"}, {1, "WASTED"}};
constexpr Legend::Tick kCounts[]{{1, "1"}, {10, "10"}, {100, "100"}, {1000, "1000"}, {10000, "10000"}};
constexpr Legend::Tick kSlabs[]{{1, "1"}, {8, "8"}, {64, "64"}, {512, "512"}};
constexpr Legend::Tick kDepths[]{{0.01, "0.01"}, {0.1, "0.1"}, {1, "1"}, {10, "10"}};
constexpr Legend::Tick kParts[]{{0, "0"}, {0.5, "50%"}, {1, "100%"}};
constexpr Legend::Tick kErrors[]{{1e-4, "0.01%"}, {1e-3, "0.1%"}, {1e-2, "1%"}, {0.1, "10%"}, {1, "100%"}};

constexpr Legend kAll[kLegends]{
    {gpu::kShowWasted, "WASTED PIXELS OF THE TETRAHEDRA", kHalves},
    {gpu::kShowOverdraw, "TETRAHEDRA THAT COVER A PIXEL", kCounts},
    {gpu::kShowOverdraw, "SPHERES THAT COVER A PIXEL", kCounts},
    {gpu::kShowParticles, "PARTICLES IN 16 X 16 PIXELS", kCounts},
    {gpu::kShowRays, "SLABS WITH MEDIUM ON EACH RAY", kSlabs},
    {gpu::kShowRays, "THIS METHOD HAS NO COARSE RAYS", {}},
    {gpu::kShowDepth, "OF GAUSSIANS: THIS MEDIUM HAS NONE", {}},
    {gpu::kShowDepth, "OPTICAL DEPTH BEFORE SURFACES", kDepths},
    {gpu::kShowShadow, "OPTICAL DEPTH TO THE SUN, BY PLANES", kDepths},
    {gpu::kShowShadow, "THERE IS NO SUN TO CAST A SHADOW", {}},
    {gpu::kShowLight, "SUNLIGHT THAT ARRIVES AT PARTICLES", kParts},
    {gpu::kShowLight, "THERE IS NO SUN TO LIGHT PARTICLES", {}},
    {gpu::kShowError, "ERROR OF MEASURED PIXELS", kErrors},
    {gpu::kShowError, "NO PIXEL IS MEASURED YET", {}},
};

uint32_t widthOf(std::string_view text) { return text.empty() ? 0 : uint32_t(text.size()) * kAdvance - 1; }

void write(LegendPicture& picture, glm::uvec2 at, std::string_view text) {
    for (const char character : text) {
        const auto* glyph = std::ranges::find(kFont, character, &Glyph::character);
        if (glyph != std::end(kFont))
            for (uint32_t y = 0; y < kHeight; ++y)
                for (uint32_t x = 0; x < 5; ++x)
                    if (glyph->rows[y] >> (4 - x) & 1) picture.pixels[(at.y + y) * picture.size.x + at.x + x] = kInk;
        at.x += kAdvance;
    }
}

uint32_t byteOf(float part) { return uint32_t(std::lround(255 * part)); }

} // namespace

const Legend& legendOf(LegendOf which) { return kAll[uint32_t(which)]; }

LegendPicture drawLegend(const Legend& legend) {
    const bool bar = !legend.ticks.empty();
    LegendPicture picture;
    picture.size = {2 * kMargin + std::max(widthOf(legend.title), bar ? kBarWidth : 0),
                    2 * kMargin + kHeight + (bar ? 2 * kGap + kBarHeight + kHeight : 0)};
    picture.pixels.assign(size_t(picture.size.x) * picture.size.y, kPaper);
    write(picture, {kMargin, kMargin}, legend.title);
    if (!bar) return picture;
    const uint32_t top = kMargin + kHeight + kGap;
    for (uint32_t x = 0; x < kBarWidth; ++x) {
        const glm::vec3 rgb = physics::shownColour(legend.show, float(x) / float(kBarWidth - 1));
        const uint32_t word = 0xffu << 24 | byteOf(rgb.b) << 16 | byteOf(rgb.g) << 8 | byteOf(rgb.r);
        for (uint32_t y = 0; y < kBarHeight; ++y) picture.pixels[(top + y) * picture.size.x + kMargin + x] = word;
    }
    for (const Legend::Tick& tick : legend.ticks) {
        const auto at = uint32_t(std::lround(physics::shownPart(legend.show, tick.value) * (kBarWidth - 1)));
        const uint32_t wide = widthOf(tick.text), left = at > wide / 2 ? at - wide / 2 : 0;
        for (uint32_t y = 0; y < 2; ++y) picture.pixels[(top + kBarHeight + y) * picture.size.x + kMargin + at] = kInk;
        write(picture, {kMargin + std::min(left, kBarWidth - wide), top + kBarHeight + kGap}, tick.text);
    }
    return picture;
}

} // namespace brume
