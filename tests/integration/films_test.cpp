// Films of key views, pictures without their sky, and changes that are taken back: by the real programs.
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <png.h>

#include "client/native/film_writer.h"
#include "client/native/jpeg.h"
#include "common/scene_text.h"
#include "server/encode/cut_out.h"
#include "tests/integration/http.h"
#include "tests/integration/program.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"

namespace brume::test::films_test {
namespace {

namespace fs = std::filesystem;

class Films : public testing::Test {
protected:
    static void SetUpTestSuite() {
        const fs::path scene = fs::temp_directory_path() / ("brume-films-" + std::to_string(getpid()) + ".toml");
        std::ofstream(scene) << "[medium]\ncount = 60\n[[light]]\n[[sphere]]\ncentre = [4, 0, 3]\nradius = 3\n"
                                "albedo = [0.02, 0.02, 0.05]\n[[camera.key]]\nposition = [0, 2, 26]\n"
                                "[[camera.key]]\nposition = [26, 2, 0]\nseconds = 0.5\n";
        server_ = new RunningServer({"--ahead", "off", "--scene", scene.string(), "--paused"});
    }
    static void TearDownTestSuite() {
        delete server_;
        server_ = nullptr;
    }
    void SetUp() override {
        out_ = fs::temp_directory_path() / ("brume-films-" + std::to_string(getpid()));
        fs::remove_all(out_);
        fs::create_directories(out_);
    }
    void TearDown() override { fs::remove_all(out_); }

    static std::unique_ptr<Process> film(std::vector<std::string> arguments,
                                         const std::vector<std::string>& environment = {}) {
        arguments.insert(arguments.begin(), {"--headless", "--url", server_->url(), "--size", "160x90"});
        return startProgram(BRUME_CLIENT, arguments, environment);
    }
    // A program called ffmpeg that keeps what it is told and what it reads.
    std::string pathWithFfmpeg() const {
        std::ofstream(out_ / "ffmpeg") << "#!/bin/sh\necho \"$@\" > " << (out_ / "told").string()
                                       << "\nfor out; do :; done\ncat > \"$out\"\n";
        fs::permissions(out_ / "ffmpeg", fs::perms::owner_all);
        return "PATH=" + out_.string() + ":/usr/bin:/bin";
    }
    static std::string bytesOf(const fs::path& file) {
        std::ifstream in(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(in), {}};
    }
    static std::string still(const std::string& query) { return get(server_->port(), "/snapshot." + query).body; }

    static inline RunningServer* server_ = nullptr;
    fs::path out_;
};

TEST_F(Films, OfKeyViewsAreWhatTheServerDrawsThere) {
    const auto client = film({"--path", "keys", "--fps", "4", "--out", (out_ / "frame-%03d.png").string()});
    ASSERT_EQ(client->exitCode(), 0) << client->err();
    EXPECT_NE(client->out().find("3 frames of 160x90"), std::string::npos) << client->out();
    EXPECT_EQ(bytesOf(out_ / "frame-001.png"), still("png?w=160&h=90&keep_size=1"));
    EXPECT_EQ(bytesOf(out_ / "frame-003.png"), still("png?w=160&h=90&keep_size=1&position=26,2,0"));
    EXPECT_NE(bytesOf(out_ / "frame-002.png"), bytesOf(out_ / "frame-001.png"));
    EXPECT_FALSE(fs::exists(out_ / "frame-004.png"));
}

TEST_F(Films, GoThroughFfmpeg) {
    std::ofstream(out_ / "keys.json") << R"([{"position": [0, 2, 26]}, {"position": [0, 2, 20], "seconds": 0.5}])";
    const auto client =
        film({"--path", (out_ / "keys.json").string(), "--fps", "2", "--out", (out_ / "a.mp4").string()},
             {pathWithFfmpeg()});
    ASSERT_EQ(client->exitCode(), 0) << client->err();
    EXPECT_EQ(fs::file_size(out_ / "a.mp4"), 2u * 160 * 90 * 3) << "two frames, as they are";
    EXPECT_NE(bytesOf(out_ / "told").find("-video_size 160x90 -framerate 2"), std::string::npos);
}

constexpr char kNoFfmpeg[] = "there is no /usr/bin/ffmpeg to make a film: apt-get install ffmpeg";
const bool kHasFfmpeg = fs::exists("/usr/bin/ffmpeg");

TEST_F(Films, AreWhatPlayersExpect) {
    if (!kHasFfmpeg) GTEST_SKIP() << kNoFfmpeg;
    const std::string file = (out_ / "a.mp4").string();
    const auto client = film({"--path", "keys", "--fps", "8", "--out", file});
    ASSERT_EQ(client->exitCode(), 0) << client->err();
    EXPECT_EQ(client->err(), "");
    const auto probe = startProgram(
        "/usr/bin/ffprobe",
        {"-v", "error", "-count_frames", "-select_streams", "v", "-of", "csv=p=0", "-show_entries",
         "stream=codec_name,width,height,pix_fmt,color_range,color_space,color_transfer,r_frame_rate,nb_read_frames",
         file});
    ASSERT_EQ(probe->exitCode(), 0) << probe->err();
    EXPECT_EQ(probe->out(), "h264,160,90,yuv420p,tv,bt709,iec61966-2-1,8/1,5\n");
}

// Players take large films for BT.709, whatever they say.
TEST_F(Films, HaveTheColoursOfTheirPictures) {
    if (!kHasFfmpeg) GTEST_SKIP() << kNoFfmpeg;
    constexpr uint32_t kWidth = 64, kHeight = 36;
    const std::string frame = (out_ / "frame.rgb").string();
    for (const char* name : {"a.mp4", "a.webm"})
        for (const auto& colour : {std::array{200, 60, 40}, std::array{40, 180, 60}, std::array{30, 60, 200}}) {
            std::vector<uint8_t> pixels;
            for (uint32_t i = 0; i < kWidth * kHeight; ++i) pixels.insert(pixels.end(), colour.begin(), colour.end());
            png_image image{};
            image.version = PNG_IMAGE_VERSION, image.width = kWidth, image.height = kHeight;
            image.format = PNG_FORMAT_RGB;
            png_alloc_size_t size = 0;
            ASSERT_TRUE(png_image_write_get_memory_size(image, size, 0, pixels.data(), 0, nullptr));
            std::string png(size, 0);
            ASSERT_TRUE(png_image_write_to_memory(&image, png.data(), &size, 0, pixels.data(), 0, nullptr));
            client::FilmWriter writer(out_ / name, 2, kWidth, kHeight);
            writer.add(png);
            writer.finish();
            const auto play = startProgram("/usr/bin/ffmpeg", {"-v", "error", "-y", "-i", (out_ / name).string(), "-vf",
                                                               "scale=in_color_matrix=bt709:flags=accurate_rnd", "-f",
                                                               "rawvideo", "-pix_fmt", "rgb24", frame});
            ASSERT_EQ(play->exitCode(), 0) << play->err();
            const std::string shown = bytesOf(frame);
            ASSERT_EQ(shown.size(), pixels.size());
            const size_t middle = 3 * (kWidth * kHeight / 2 + kWidth / 2);
            for (size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(uint8_t(shown[middle + c]), colour[c], 3) << name << ", channel " << c; // rounded twice
        }
}

TEST_F(Films, FailInOneLine) {
    const std::string mp4 = (out_ / "a.mp4").string();
    expectOneLine(*film({"--path", "orbit", "--out", mp4}, {"PATH=" + out_.string()}), "there is no ffmpeg");
    std::ofstream(out_ / "ffmpeg") << "#!/bin/sh\nexit 1\n";
    fs::permissions(out_ / "ffmpeg", fs::perms::owner_all);
    expectOneLine(
        *film({"--path", "orbit", "--seconds", "1", "--out", mp4}, {"PATH=" + out_.string() + ":/usr/bin:/bin"}),
        "ffmpeg");
    expectOneLine(*film({"--path", "orbit", "--seconds", "0.1", "--out", "/proc/none/%d.png"}), "/proc/none");
}

std::vector<uint8_t> rgba(const std::string& png) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    EXPECT_NE(png_image_begin_read_from_memory(&image, png.data(), png.size()), 0) << image.message;
    EXPECT_EQ(image.format & PNG_FORMAT_FLAG_ALPHA, uint32_t(PNG_FORMAT_FLAG_ALPHA));
    image.format = PNG_FORMAT_RGBA;
    std::vector<uint8_t> pixels(PNG_IMAGE_SIZE(image));
    EXPECT_NE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr), 0) << image.message;
    return pixels;
}

TEST_F(Films, PicturesWithoutTheirSkyAreThePictureOverIt) {
    const std::string plain = still("png?w=160&h=90"), cut = still("png?w=160&h=90&alpha=1");
    client::JpegDecoder decoder;
    client::Picture whole;
    const std::span bytes(reinterpret_cast<const uint8_t*>(plain.data()), plain.size());
    ASSERT_TRUE(decoder.decode(bytes, 160, 90, whole)) << decoder.error();
    const std::vector<uint8_t> pixels = rgba(cut);
    ASSERT_EQ(pixels.size(), 160u * 90 * 4);
    const Scene scene = sceneOf(get(server_->port(), "/scene.toml").body, "a.toml");
    RawPicture sky{.width = 160, .height = 90};
    sky.eye = lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y);
    sky.sky = scene.sky;
    sky.exposure = scene.render.exposure;
    size_t clear = 0, opaque = 0, between = 0;
    for (uint32_t y = 0, i = 0; y < 90; ++y)
        for (uint32_t x = 0; x < 160; ++x, ++i) {
            const glm::vec3 behind = shown(sky, skyBehind(sky, x, y));
            const uint8_t* const pixel = &pixels[4 * size_t{i}];
            const float alpha = float(pixel[3]) / 255;
            for (int c = 0; c < 3; ++c) {
                const float over = alpha * float(pixel[c]) + (1 - alpha) * 255 * behind[c];
                // The picture, alpha and colour are rounded, half a level each, and the medium is once a field that
                // is interpolated in half floats.
                EXPECT_NEAR(over, float(whole.rgb[3 * size_t{i} + size_t(c)]), 2.01f) << x << ' ' << y;
            }
            clear += pixel[3] == 0, opaque += pixel[3] == 255, between += pixel[3] > 0 && pixel[3] < 255;
        }
    EXPECT_GT(clear, 1000u) << "sky";
    EXPECT_GT(opaque, 100u) << "the sphere";
    EXPECT_GT(between, 1000u) << "the medium";
}

TEST_F(Films, PicturesWithoutTheirSkyHaveTheirFormats) {
    const HttpReply exr = get(server_->port(), "/snapshot.exr?w=64&h=36");
    EXPECT_EQ(exr.status, 200);
    EXPECT_EQ(exr.headers.at("content-type"), "image/x-exr");
    EXPECT_EQ(exr.body.substr(0, 4), std::string("\x76\x2f\x31\x01", 4));
    for (const char* wrong : {"/snapshot.jpg?alpha=1", "/snapshot.png?alpha=2", "/snapshot.exr?view=depth",
                              "/stream.mjpg?alpha=1", "/snapshot.png?format=tga"}) {
        const HttpReply reply = get(server_->port(), wrong);
        EXPECT_EQ(reply.status, 400) << wrong;
        EXPECT_EQ(std::count(reply.body.begin(), reply.body.end(), '\n'), 1) << reply.body;
    }
    EXPECT_EQ(get(server_->port(), "/snapshot.jpg?w=64&h=36").status, 200) << "and all goes on";
}

TEST_F(Films, TheSceneSavesOtherKeyViews) {
    const auto saved = [](const std::string& query) {
        return sceneOf(get(server_->port(), "/scene.toml" + query).body, "a.toml").camera_keys;
    };
    EXPECT_EQ(saved("").size(), 2u);
    EXPECT_EQ(saved("?path=").size(), 0u);
    const auto keys = saved("?path=0,2,9,0,0,0,0.8,0_1,2,9,0,0,0,0.5,2.5");
    ASSERT_EQ(keys.size(), 2u);
    EXPECT_EQ(keys[1].seconds, 2.5f);
    EXPECT_EQ(get(server_->port(), "/scene.toml?path=1,2").status, 400);
}

TEST_F(Films, OneViewerTakesBackWhatAnotherHasChanged) {
    Watcher a(server_->endpoint()), b(server_->endpoint());
    a.session.sendCommand<wire::Set>([](auto& to) {
        const std::vector changes{wire::CreateChangeDirect(to, "medium.extinction", 3)};
        return wire::CreateSetDirect(to, &changes);
    });
    const auto extinction = [] {
        return sceneOf(get(server_->port(), "/scene.toml").body, "a.toml").medium.extinction;
    };
    ASSERT_TRUE(watch({&a, &b}, [&] { return extinction() == 3; }));
    b.session.sendUndo();
    ASSERT_TRUE(watch({&a, &b}, [&] { return extinction() == Medium{}.extinction; }));
    EXPECT_TRUE(b.errors.empty());
    b.session.sendUndo();
    ASSERT_TRUE(watch({&a, &b}, [&] { return !b.errors.empty(); }));
}

} // namespace
} // namespace brume::test::films_test
