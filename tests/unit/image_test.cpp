// Pictures: files that come back bit for bit, broken files that are refused, and what a viewer would see.
#include "common/image.h"

#include <bit>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gtest/gtest.h>
#include <png.h>
#include <unistd.h>

namespace brume {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNaN = std::numeric_limits<float>::quiet_NaN();

// A folder of this test program's own, gone with the test.
class ImageFiles : public testing::Test {
protected:
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }
    std::filesystem::path file(const std::string& name) const { return folder_ / name; }

private:
    std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() / ("brume-image-test-" + std::to_string(::getpid()));
};

RadianceImage blank(int width, int height) {
    const size_t pixels = size_t(width) * height;
    return {width, height, std::vector<glm::vec3>(pixels), std::vector<float>(pixels, 1.0f)};
}

template <class Call>
std::string errorOf(Call call) {
    try {
        call();
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "no error";
}

std::string bytesOf(const std::filesystem::path& file) {
    std::ostringstream out;
    out << std::ifstream(file, std::ios::binary).rdbuf();
    return out.str();
}

void writeBytes(const std::filesystem::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
}

// One line that names the file.
void expectRefused(const std::filesystem::path& file, const std::string& because) {
    const std::string error = errorOf([&] { readExr(file); });
    EXPECT_TRUE(error.starts_with(file.string() + ": EXR: ")) << error;
    EXPECT_NE(error.find(because), std::string::npos) << error;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

// An EXR of other programs: any channels, half or float, its data window anywhere.
void writeOther(const std::filesystem::path& file, const Imath::Box2i& window, Imf::PixelType type,
                const std::string& channels) {
    Imf::Header header(Imath::Box2i({0, 0}, {63, 63}), window);
    const size_t pixels = size_t(window.max.x - window.min.x + 1) * (window.max.y - window.min.y + 1);
    std::vector<std::vector<half>> halves;
    std::vector<std::vector<float>> floats;
    Imf::FrameBuffer buffer;
    for (const char name : channels) {
        auto& h = halves.emplace_back(pixels);
        auto& f = floats.emplace_back(pixels);
        for (size_t i = 0; i < pixels; ++i)
            h[i] = f[i] = static_cast<float>(i) + static_cast<float>(name); // exact as half
        const void* first = type == Imf::HALF ? static_cast<const void*>(h.data()) : f.data();
        header.channels().insert(std::string(1, name), Imf::Channel(type));
        buffer.insert(std::string(1, name), Imf::Slice::Make(type, first, window));
    }
    Imf::OutputFile out(file.c_str(), header);
    out.setFrameBuffer(buffer);
    out.writePixels(window.max.y - window.min.y + 1);
}

TEST_F(ImageFiles, ExrComesBackBitForBit) {
    for (const auto& [width, height] : {std::pair{37, 23}, {1, 1}, {3, 700}}) { // 700 rows: more than one band
        RadianceImage image = blank(width, height);
        uint32_t state = 1;
        for (auto& pixel : image.radiance)
            for (int c = 0; c < 3; ++c) {
                state = state * 1664525u + 1013904223u;
                pixel[c] = std::bit_cast<float>(state); // every kind of number
            }
        for (float& t : image.transmittance)
            t = static_cast<float>((state = state * 1664525u + 1013904223u) >> 8) * 0x1p-24f;
        image.radiance.front() = {kNaN, -kInfinity, std::numeric_limits<float>::denorm_min()};
        writeExr(file("a.exr"), image);
        const RadianceImage back = readExr(file("a.exr"));
        ASSERT_EQ(back.width, width);
        ASSERT_EQ(back.height, height);
        ASSERT_EQ(back.radiance.size(), image.radiance.size());
        ASSERT_EQ(back.transmittance.size(), image.transmittance.size());
        EXPECT_EQ(std::memcmp(back.radiance.data(), image.radiance.data(), sizeof(glm::vec3) * image.radiance.size()),
                  0);
        EXPECT_EQ(std::memcmp(back.transmittance.data(), image.transmittance.data(),
                              sizeof(float) * image.transmittance.size()),
                  0);
    }
}

TEST_F(ImageFiles, ExrKeepsEdgesAndWhetherTheMediumIsAlone) {
    RadianceImage image = blank(5, 600); // more than one band
    writeExr(file("plain.exr"), image);
    EXPECT_TRUE(readExr(file("plain.exr")).edges.empty());
    EXPECT_FALSE(readExr(file("plain.exr")).medium_alone);
    image.edges.resize(image.radiance.size());
    image.edges[7] = image.edges[2999] = 1;
    image.medium_alone = true;
    writeExr(file("edges.exr"), image);
    EXPECT_EQ(readExr(file("edges.exr")).edges, image.edges);
    EXPECT_TRUE(readExr(file("edges.exr")).medium_alone);
    image.edges.pop_back();
    EXPECT_THROW(writeExr(file("edges.exr"), image), std::runtime_error);
}

TEST_F(ImageFiles, ReadsHalfAndFloatWithAndWithoutTransmittanceFromAnyDataWindow) {
    for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT})
        for (const std::string channels : {"BGR", "BGRT", "ABGR"}) {
            writeOther(file("other.exr"), {{-5, 7}, {6, 13}}, type, channels);
            const RadianceImage image = readExr(file("other.exr"));
            ASSERT_EQ(image.width, 12);
            ASSERT_EQ(image.height, 7);
            for (size_t i = 0; i < image.radiance.size(); ++i) {
                const float at = static_cast<float>(i);
                ASSERT_EQ(image.radiance[i], glm::vec3(at + 'R', at + 'G', at + 'B')) << i;
                ASSERT_EQ(image.transmittance[i], channels.ends_with('T') ? at + 'T' : 1.0f) << i;
            }
        }
}

TEST_F(ImageFiles, BrokenExrsAreRefused) {
    expectRefused(file("missing.exr"), "cannot be read");
    expectRefused(file(""), "cannot be read"); // a folder
    writeBytes(file("empty.exr"), "");
    expectRefused(file("empty.exr"), "cannot be read");
    writeBytes(file("text.exr"), "not a picture, though it is as long as a header has to be: " + std::string(500, '.'));
    expectRefused(file("text.exr"), "cannot be read");
    writeOther(file("grey.exr"), {{0, 0}, {3, 3}}, Imf::HALF, "Y");
    expectRefused(file("grey.exr"), "no channel R");
    writeOther(file("red.exr"), {{0, 0}, {3, 3}}, Imf::FLOAT, "RG");
    expectRefused(file("red.exr"), "no channel B");
}

TEST_F(ImageFiles, ExrsCutAnywhereAreRefused) {
    RadianceImage image = blank(16, 40);
    for (size_t i = 0; i < image.radiance.size(); ++i) image.radiance[i] = glm::vec3(static_cast<float>(i * i % 97));
    writeExr(file("whole.exr"), image);
    const std::string whole = bytesOf(file("whole.exr"));
    for (size_t length = 0; length < whole.size(); length += 13) {
        writeBytes(file("cut.exr"), whole.substr(0, length));
        expectRefused(file("cut.exr"), "cannot be read");
    }
}

TEST_F(ImageFiles, ExrsThatClaimToBeTooLargeAreRefused) {
    writeExr(file("small.exr"), blank(4, 4));
    const std::string small = bytesOf(file("small.exr"));
    const size_t window = small.find("dataWindow");
    ASSERT_NE(window, std::string::npos);
    const auto claim = [&](size_t coordinate, int32_t last,
                           const std::string& because) { // of min x, min y, max x, max y
        std::string large = small;
        std::memcpy(&large[window + sizeof("dataWindow") + sizeof("box2i") + 4 + 4 * coordinate], &last, 4);
        writeBytes(file("large.exr"), large);
        expectRefused(file("large.exr"), because);
    };
    for (const size_t coordinate : {2u, 3u})
        for (const int32_t last : {16384, 1 << 20, std::numeric_limits<int32_t>::max()})
            claim(coordinate, last, "data window");
    claim(3, 16383, "cannot be read"); // as many rows as are allowed, but they are not there
}

TEST_F(ImageFiles, WhatCannotBeWrittenIsSaid) {
    RadianceImage image = blank(4, 4);
    const auto saysSo = [&](const std::filesystem::path& name) {
        const std::string exr = errorOf([&] { writeExr(name, image); });
        EXPECT_TRUE(exr.starts_with(name.string() + ": EXR: ")) << exr;
        EXPECT_EQ(exr.find('\n'), std::string::npos) << exr;
    };
    saysSo(file("no/such/folder.exr"));
    saysSo("/dev/full");
    image.transmittance.pop_back();
    saysSo(file("short.exr"));
    image = blank(4, 0);
    saysSo(file("flat.exr"));

    const std::vector<glm::u8vec3> pixels(16);
    EXPECT_NE(errorOf([&] { writePng(file("no/such/folder.png"), 4, 4, pixels); }).find("folder.png: PNG: "),
              std::string::npos);
    EXPECT_NE(errorOf([&] { writePng(file("a.png"), 4, 5, pixels); }).find("width * height"), std::string::npos);
}

TEST_F(ImageFiles, PngHoldsThePixels) {
    std::vector<glm::u8vec3> pixels;
    for (int i = 0; i < 7 * 5; ++i) pixels.emplace_back(i * 7, 255 - i, i % 2 * 255);
    writePng(file("a.png"), 7, 5, pixels);
    png_image back{};
    back.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_file(&back, file("a.png").c_str())) << back.message;
    ASSERT_EQ(back.width, 7u);
    ASSERT_EQ(back.height, 5u);
    EXPECT_EQ(back.format, png_uint_32(PNG_FORMAT_RGB));
    std::vector<glm::u8vec3> read(pixels.size());
    ASSERT_TRUE(png_image_finish_read(&back, nullptr, read.data(), 0, nullptr)) << back.message;
    EXPECT_EQ(read, pixels);
}

RadianceImage pixelsOf(const std::vector<glm::vec3>& radiance) {
    return {static_cast<int>(radiance.size()), 1, radiance, std::vector<float>(radiance.size(), 1.0f)};
}

TEST(Display, LinearIsClippedAndUnderTheSrgbCurve) {
    const RadianceImage image = pixelsOf({{0, 0.5f, 1}, {-1, 2, 0.001f}, {kNaN, kInfinity, -kInfinity}});
    const auto light = displayedLight(image, {.exposure = 0.5f, .filmic = false});
    EXPECT_EQ(light[0], glm::vec3(0, 0.25f, 0.5f));
    EXPECT_EQ(light[1], glm::vec3(0, 1, 0.0005f));
    EXPECT_EQ(light[2], glm::vec3(0, 1, 0));
    // IEC 61966-2-1 of 0.25 and 0.5: 0.5371 and 0.7354; of 0.0005: 12.92 * 0.0005 = 0.00646.
    const auto shown = displayed(image, {.exposure = 0.5f, .filmic = false});
    EXPECT_EQ(shown[0], glm::u8vec3(0, 137, 188));
    EXPECT_EQ(shown[1], glm::u8vec3(0, 255, 2));
    EXPECT_EQ(shown[2], glm::u8vec3(0, 255, 0));
}

TEST(Display, FilmicRisesFromBlackToWhite) {
    std::vector<glm::vec3> ramp;
    for (int i = 0; i <= 400; ++i) ramp.emplace_back(0.02f * static_cast<float>(i));
    const auto light = displayedLight(pixelsOf(ramp), {});
    for (size_t i = 1; i < light.size(); ++i) ASSERT_GE(light[i].x, light[i - 1].x) << i;
    EXPECT_EQ(light.front().x, 0);
    EXPECT_NEAR(light[50].x, 2.54 / 3.16, 1e-6); // radiance 1, by the formula's own numbers; float32 rounding
    EXPECT_EQ(light.back().x, 1);                // 8: the curve passes 1 near 7.2
    EXPECT_EQ(displayedLight(pixelsOf({{1e30f, kInfinity, 1e4f}}), {})[0], glm::vec3(1));
    EXPECT_EQ(displayedLight(pixelsOf({{0.5f, 1, 2}}), {.exposure = 2})[0],
              displayedLight(pixelsOf({{1, 2, 4}}), {})[0]);
}

TEST(Display, MaskHoldsPixelsWithMedium) {
    RadianceImage image = blank(5, 1);
    image.transmittance = {0, 0.9985f, 0.9995f, 1, kNaN};
    EXPECT_EQ(mediumMask(image, 1e-3f), (std::vector<uint8_t>{1, 1, 0, 0, 0}));
    EXPECT_EQ(mediumMask(image, 1e-4f), (std::vector<uint8_t>{1, 1, 1, 0, 0}));
}

} // namespace
} // namespace brume
