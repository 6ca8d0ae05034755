// Pictures that rest: R, G, B of every pixel instead of planes with 4:2:0 chroma, and what the encoders make of them.
#include <algorithm>
#include <cmath>

#include <png.h>
#include <turbojpeg.h>

#include "server/encode/jpeg.h"
#include "server/encode/png.h"
#include "tests/gpu/fixture.h"

namespace brume::test::full_colour_test {
namespace {

class FullColourTest : public GpuTest {
protected:
    struct Rgb {
        uint32_t width = 0, height = 0;
        std::vector<uint8_t> bytes; // packed
        const uint8_t* at(uint32_t x, uint32_t y) const { return &bytes[3 * (size_t(y) * width + x)]; }
    };
    static Rgb packed(const PictureView& picture) {
        const PlaneLayout& layout = picture.layout;
        Rgb out{layout.width, layout.height, {}};
        for (uint32_t y = 0; y < layout.height; ++y)
            for (uint32_t x = 0; x < layout.width; ++x)
                for (size_t c = 0; c < 3; ++c)
                    out.bytes.push_back(picture.bytes[c * layout.lumaBytes() + size_t(y) * layout.lumaStride() + x]);
        return out;
    }
};

// The same picture as planes for JPEG: brightness of every pixel, and the mean colour of every four. Bounds: R, G and B
// are rounded to whole levels, so a weighted sum of them is off by half of one, and so is what is compared with: one
// level together.
TEST_F(FullColourTest, IsThePictureOfThePlanes) {
    struct Case {
        const char *scene, *method;
        uint32_t rate;
        uint32_t width, height;
        uint32_t shading = 0; // 1: every pixel
    };
    for (const auto& [name, method, rate, width, height, shading] :
         {Case{"cloud", "slabs", 8, 161, 91}, Case{"cloud", "slabs", 4, 90, 63, 1}, Case{"cloud", "grid", 8, 33, 31},
          Case{"props", "slabs", 4, 90, 65}, Case{"props", "sphere", 0, 64, 48}, Case{"cloud", "sphere", 4, 120, 80},
          Case{"cloud", "slabs", 2, 1, 1}}) {
        SCOPED_TRACE(testing::Message() << name << ' ' << method << ' ' << rate);
        Scene scene = loadScene("server/scenes/" + std::string(name) + ".toml");
        scene.render.method = method;
        scene.render.rate = rate;
        scene.render.shading = shading;
        scene.render.shadow_size = 64;
        const Simulation simulation(scene);
        Renderer renderer(device(), scene, simulation.capacity());
        Submission plain(device(), "planes"), full(device(), "full");
        const EyeRequest eyes[]{{lookAt(scene.camera.position, scene.camera.target, 0.8f), width, height},
                                {lookAt({20, 3, 5}, {0, 0, 0}, 0.6f), 65, 49}};
        submitAndWait(renderer, plain, simulation, eyes);
        renderer.submit(full, simulation, eyes, nullptr, true);
        waitFor(full.commands);
        for (size_t eye = 0; eye < 2; ++eye) {
            const PictureView a = plain.pictures()[eye];
            const Rgb b = packed(full.pictures()[eye]);
            const PlaneLayout& layout = a.layout;
            ASSERT_EQ(full.pictures()[eye].layout.bytes(), 3 * layout.lumaBytes());
            const uint8_t *cb = a.bytes + layout.lumaBytes(), *cr = cb + layout.chromaBytes();
            for (uint32_t y = 0; y < layout.height; ++y)
                for (uint32_t x = 0; x < layout.width; ++x) {
                    const uint8_t* p = b.at(x, y);
                    ASSERT_NEAR(a.bytes[y * layout.lumaStride() + x], 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2], 1.01)
                        << x << ' ' << y;
                }
            for (uint32_t y = 0; y < layout.chromaHeight(); ++y)
                for (uint32_t x = 0; x < (layout.width + 1) / 2; ++x) {
                    double blue = 0, red = 0; // pixels beyond the edge repeat it
                    for (uint32_t i = 0; i < 4; ++i) {
                        const uint8_t* p =
                            b.at(std::min(2 * x + i % 2, layout.width - 1), std::min(2 * y + i / 2, layout.height - 1));
                        const double luma = 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
                        blue += (p[2] - luma) / 1.772 / 4, red += (p[0] - luma) / 1.402 / 4;
                    }
                    // Of a band-limited picture the planes hold the chroma between the four, not their mean: off by
                    // what it curves.
                    ASSERT_NEAR(cb[y * layout.chromaStride() + x], 128 + blue, 1.6) << x << ' ' << y;
                    ASSERT_NEAR(cr[y * layout.chromaStride() + x], 128 + red, 1.6) << x << ' ' << y;
                }
        }
    }
}

TEST_F(FullColourTest, PngKeepsEveryBitAndJpegAllOfTheColour) {
    Scene scene = loadScene("server/scenes/props.toml");
    scene.render.method = "slabs";
    const Simulation simulation(scene);
    Renderer renderer(device(), scene, simulation.capacity());
    Submission submission(device(), "full");
    const EyeRequest eye{lookAt(scene.camera.position, scene.camera.target, 0.8f), 161, 91};
    renderer.submit(submission, simulation, {&eye, 1}, nullptr, true);
    waitFor(submission.commands);
    const PictureView picture = submission.pictures()[0];
    const Rgb expected = packed(picture);

    const std::vector<uint8_t> png = encodePng(picture, 1 << 20);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_memory(&image, png.data(), png.size())) << image.message;
    ASSERT_EQ(image.width, eye.width);
    ASSERT_EQ(image.height, eye.height);
    image.format = PNG_FORMAT_RGB;
    std::vector<uint8_t> read(PNG_IMAGE_SIZE(image));
    ASSERT_TRUE(png_image_finish_read(&image, nullptr, read.data(), 0, nullptr)) << image.message;
    EXPECT_EQ(read, expected.bytes);
    EXPECT_TRUE(encodePng(picture, png.size() / 2).empty()); // bounded
    EXPECT_EQ(encodePng(picture, png.size()), png);

    const std::vector<uint8_t> jpeg = JpegEncoder().encode(picture, 90);
    const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
    int width = 0, height = 0, sampling = 0, colours = 0;
    ASSERT_EQ(tjDecompressHeader3(decoder.get(), jpeg.data(), static_cast<unsigned long>(jpeg.size()), &width, &height,
                                  &sampling, &colours),
              0);
    EXPECT_EQ(width, int(eye.width));
    EXPECT_EQ(height, int(eye.height));
    EXPECT_EQ(sampling, TJSAMP_444);
    ASSERT_EQ(tjDecompress2(decoder.get(), jpeg.data(), static_cast<unsigned long>(jpeg.size()), read.data(), width, 0,
                            height, TJPF_RGB, 0),
              0);
    double squares = 0;
    for (size_t i = 0; i < read.size(); ++i) squares += std::pow(double(read[i]) - double(expected.bytes[i]), 2);
    // Quality 90 quantises brightness in steps of 2 to 20 levels, most of all where there is little: a uniform error of
    // four.
    EXPECT_LT(std::sqrt(squares / double(read.size())), 4 / std::sqrt(12.0) * 2);
}

} // namespace
} // namespace brume::test::full_colour_test
