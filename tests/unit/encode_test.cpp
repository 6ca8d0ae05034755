// Encoding without a device: what threads do with jobs, and which format a picture gets.
#include <chrono>
#include <future>
#include <new>
#include <system_error>
#include <thread>

#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/resource.h>
#include <unistd.h>

#include "server/encode/picture_encoder.h"
#include "server/encode/workers.h"
#include "tests/layer.h"

namespace brume {
namespace {

// Want of memory on an encoder's thread costs one picture, not the process.
TEST(EncodeWorkers, AJobThatThrowsIsLostAndTheNextOneRuns) {
    EncodeWorkers workers(1);
    std::promise<int> next;
    workers.give([](JpegEncoder&) { throw std::bad_alloc(); });
    workers.give([&](JpegEncoder&) { next.set_value(7); });
    std::future<int> answer = next.get_future();
    ASSERT_EQ(answer.wait_for(std::chrono::seconds(30)), std::future_status::ready);
    EXPECT_EQ(answer.get(), 7);
}

// The scratch memory of a picture that was large goes back, and the next picture is the same.
TEST(EncodeWorkers, ScratchMemoryIsCountedAndGivenBack) {
    const PlaneLayout layout{1920, 1080, true};
    const std::vector<uint8_t> planes(layout.bytes(), 100);
    const PictureView picture{layout, planes.data()};
    EncodeWorkers workers(2);
    const auto encoded = [&] {
        std::promise<std::vector<uint8_t>> done;
        workers.give([&](JpegEncoder& jpeg) { done.set_value(jpeg.encode(picture, 80)); });
        return done.get_future().get();
    };
    const auto becomes = [&](auto&& holds) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(30);
        while (!holds() && std::chrono::steady_clock::now() < end) std::this_thread::yield();
        return holds();
    };
    EXPECT_EQ(workers.bytes(), 0u);
    const auto before = encoded();
    EXPECT_TRUE(becomes([&] { return workers.bytes() >= size_t{2} * 3 * 1920 * 1080; })) << workers.bytes();
    for (int i = 0; i < 3; ++i) workers.giveBack();
    EXPECT_TRUE(becomes([&] { return workers.bytes() == 0; })) << workers.bytes();
    EXPECT_EQ(encoded(), before);
}

class PictureEncoder : public testing::Test {
protected:
    // R, G, B of 16x8 pixels.
    PlaneLayout layout{16, 8, true};
    std::vector<uint8_t> planes = std::vector<uint8_t>(layout.bytes(), 100);
    std::array<PictureView, 2> eyes{PictureView{layout, planes.data()}, PictureView{layout, planes.data()}};
    JpegEncoder jpeg;
};

TEST_F(PictureEncoder, BothEyesGetTheFormatThatIsAskedFor) {
    const EncodedPictures lossy = encodePictures(eyes, {.quality = 70}, jpeg);
    EXPECT_EQ(lossy.format, PictureFormat::jpeg);
    EXPECT_EQ(lossy.quality, 70);
    const EncodedPictures exact = encodePictures(eyes, {.quality = 70, .lossless = true}, jpeg);
    EXPECT_EQ(exact.format, PictureFormat::png);
    EXPECT_EQ(exact.quality, 100);
    for (const size_t eye : {size_t(0), size_t(1)}) {
        ASSERT_TRUE(lossy.bytes[eye] && exact.bytes[eye]);
        EXPECT_EQ(lossy.bytes[eye]->front(), 0xff); // a JPEG begins so,
        EXPECT_EQ(exact.bytes[eye]->front(), 0x89); // and a PNG so
    }
}

// Noise does not shrink: beyond 4 MiB a lossless picture comes as JPEG of high quality.
TEST_F(PictureEncoder, ALosslessPictureThatIsTooLargeComesAsJpeg) {
    const PlaneLayout large{1600, 1200, true};
    std::vector<uint8_t> noise(large.bytes());
    uint32_t bits = 1;
    for (uint8_t& byte : noise) byte = uint8_t((bits = bits * 1664525 + 1013904223) >> 24);
    const PictureView view{large, noise.data()};
    const EncodedPictures pictures = encodePictures({&view, 1}, {.quality = 80, .lossless = true}, jpeg);
    EXPECT_EQ(pictures.format, PictureFormat::jpeg);
    EXPECT_EQ(pictures.quality, 97);
}

TEST_F(PictureEncoder, APictureWithoutPixelsIsRefused) {
    const PictureView none{{0, 0, false}, planes.data()};
    EXPECT_THROW(encodePictures({&none, 1}, {}, jpeg), std::runtime_error);
}

// Those that were started are stopped: nobody waits for them for ever.
TEST(EncodeWorkersDeathTest, ThreadsThatCannotBeStartedAreAnError) {
    if (test::kSanitized) GTEST_SKIP() << "sanitizers need more address space than there is";
    const auto start = [] {
        ::alarm(20);
        // Two stacks fit, and enough is left for what those two threads need.
        pthread_attr_t large;
        ::pthread_attr_init(&large);
        ::pthread_attr_setstacksize(&large, 200u << 20);
        ::pthread_setattr_default_np(&large);
        const rlimit little{600u << 20, 600u << 20};
        ::setrlimit(RLIMIT_AS, &little);
        try {
            const EncodeWorkers workers(1000);
        } catch (const std::system_error&) {
            std::_Exit(7);
        }
        std::_Exit(0);
    };
    EXPECT_EXIT(start(), testing::ExitedWithCode(7), "");
}

} // namespace
} // namespace brume
