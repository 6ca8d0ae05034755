// Truth on disk: what is kept is what was made, and nothing else is ever taken for it.
#include "tests/gpu/truth.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "tools/reference/pixel.h"

namespace brume::test::truth_test {
namespace {

namespace fs = std::filesystem;

class TruthTest : public testing::Test {
protected:
    void SetUp() override {
        if (const char* named = std::getenv("BRUME_TRUTH")) before_ = named;
        fs::remove_all(folder_);
        ::setenv("BRUME_TRUTH", folder_.c_str(), 1);
    }
    void TearDown() override {
        before_ ? ::setenv("BRUME_TRUTH", before_->c_str(), 1) : ::unsetenv("BRUME_TRUTH");
        fs::remove_all(folder_);
    }

    std::vector<double> numbers(double key, const std::vector<double>& made) {
        reference::Numbers of;
        of.add(key);
        return kept(of, made.size(), [&] { return ++times_, made; });
    }
    size_t files() const {
        return fs::exists(folder_) ? size_t(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()))
                                   : 0;
    }
    fs::path file() const { return fs::directory_iterator(folder_)->path(); }

    const fs::path folder_ = fs::path(testing::TempDir()) / "brume-truth-test";
    std::optional<std::string> before_;
    int times_ = 0; // that numbers were made
};

TEST_F(TruthTest, IsMadeOnce) {
    EXPECT_EQ(numbers(1, {0.1, -0.0, 1e300}), (std::vector{0.1, -0.0, 1e300}));
    EXPECT_EQ(numbers(1, {0.1, -0.0, 1e300}), (std::vector{0.1, -0.0, 1e300}));
    EXPECT_EQ(times_, 1);
    numbers(2, {0.1, -0.0, 1e300});
    EXPECT_EQ(times_, 2) << "another key";
    EXPECT_EQ(files(), 2u);
}

TEST_F(TruthTest, NothingIsKeptWithoutAFolder) {
    ::setenv("BRUME_TRUTH", "", 1);
    numbers(1, {1}), numbers(1, {1});
    EXPECT_EQ(times_, 2);
    EXPECT_EQ(files(), 0u);
    ::setenv("BRUME_TRUTH", "/proc/nowhere", 1); // where nothing can be written
    EXPECT_EQ(numbers(1, {1}), std::vector{1.0});
    EXPECT_EQ(times_, 3);
}

// A byte of the key, of the reference's build, of the hash or of a number; too few or too many; another key's file.
TEST_F(TruthTest, ADamagedFileIsMadeAnew) {
    const std::vector<double> made{1, 2, 3};
    numbers(1, made);
    const fs::path at = file();
    const auto size = fs::file_size(at);
    int expected = 1;
    for (uintmax_t i = 0; i < size; i += 5) {
        std::fstream bytes(at, std::ios::binary | std::ios::in | std::ios::out);
        bytes.seekg(std::streamoff(i));
        const auto byte = char(bytes.get() ^ 1);
        bytes.seekp(std::streamoff(i));
        bytes.put(byte);
        bytes.close();
        EXPECT_EQ(numbers(1, made), made);
        EXPECT_EQ(times_, ++expected) << "byte " << i;
    }
    for (const uintmax_t other : {uintmax_t(0), size - 1, size + 1}) {
        fs::resize_file(at, other);
        EXPECT_EQ(numbers(1, made), made);
        EXPECT_EQ(times_, ++expected) << other << " bytes";
    }
    numbers(2, {4, 5, 6});
    for (const auto& entry : fs::directory_iterator(folder_))
        if (entry.path() != at) fs::copy_file(entry.path(), at, fs::copy_options::overwrite_existing);
    EXPECT_EQ(numbers(1, made), made) << "under another one's name";
    EXPECT_EQ(times_, expected + 2);
    EXPECT_EQ(files(), 2u) << "no temporary files are left";
}

// A small cloud over the ground, seen from beside it.
struct View {
    View() {
        world.blobs =
            reference::blobsOf(std::vector<gpu::Particle>{{.scale = 2, .albedo = glm::vec3(1), .sigma_t = 1}}, 1.6);
        world.lights.emplace_back();
        world.obstacles.push_back({.centre = {0, -0.2, 0}});
    }
    reference::World world;
    reference::Camera camera = reference::perspective(lookAt({0, 1, 3}, {0, 0, 0}, 0.8f), 12, 8, 0.05);
};

TEST_F(TruthTest, IsThatOfTheReference) {
    const View view;
    const reference::Stage stage(view.world, {.tolerance = 1e-5});
    std::vector<glm::uvec2> pixels;
    for (uint32_t i = 0; i < 96; i += 5) pixels.emplace_back(i % 12, i / 12);
    for (int again = 0; again < 2; ++again) {
        const std::vector<TruePixel> truth = truthOf(view.world, view.camera, pixels, 1e-5);
        ASSERT_EQ(truth.size(), pixels.size());
        reference::PixelTracer tracer(stage, view.camera);
        for (size_t i = 0; i < pixels.size(); ++i) {
            const reference::PixelResult pixel = tracer.at(pixels[i]);
            EXPECT_EQ(truth[i].total, pixel.total);
            EXPECT_EQ(truth[i].transmittance, pixel.transmittance);
            EXPECT_EQ(truth[i].edge, pixel.edge);
        }
    }
    EXPECT_EQ(files(), 1u);
}

TEST_F(TruthTest, PicturesAndPathsAreThoseOfTheReference) {
    const View view;
    const reference::Picture picture = reference::render(view.world, view.camera, {.tolerance = 1e-5});
    const reference::TrackedPicture paths = reference::track(view.world, view.camera, {.samples = 4});
    for (int again = 0; again < 2; ++again) {
        const reference::Picture seen = truePicture(view.world, view.camera, 1e-5);
        EXPECT_EQ(seen.width, picture.width);
        EXPECT_EQ(seen.height, picture.height);
        EXPECT_EQ(seen.radiance, picture.radiance);
        EXPECT_EQ(seen.background, picture.background);
        EXPECT_EQ(seen.transmittance, picture.transmittance);
        const reference::TrackedPicture tracked = truePaths(view.world, view.camera, 4);
        EXPECT_EQ(tracked.radiance, paths.radiance);
        EXPECT_EQ(tracked.standard_error, paths.standard_error);
    }
    EXPECT_EQ(files(), 2u);
}

TEST_F(TruthTest, DependsOnWorldCameraPixelsAndTolerance) {
    const View view;
    View moved, other = view, lit = view;
    moved.camera.position.y += 1e-3;
    other.world.blobs[0].sigma_t *= 1.001;
    lit.world.sky_lights = true;
    const std::vector<glm::uvec2> pixels{{3, 4}, {5, 4}}, swapped{{5, 4}, {3, 4}};
    truthOf(view.world, view.camera, pixels, 1e-5);
    truthOf(moved.world, moved.camera, pixels, 1e-5);
    truthOf(other.world, other.camera, pixels, 1e-5);
    truthOf(view.world, view.camera, swapped, 1e-5);
    truthOf(view.world, view.camera, pixels, 1e-6);
    truePicture(view.world, view.camera, 1e-5);
    truePaths(view.world, view.camera, 4);
    truePaths(view.world, view.camera, 5);
    truePaths(lit.world, lit.camera, 4);
    EXPECT_EQ(files(), 9u);
}

} // namespace
} // namespace brume::test::truth_test
