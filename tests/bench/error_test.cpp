// The one definition of error: what it counts, where edges go, and that every tool prints the same number.
#include "tools/bench/error.h"

#include <cmath>
#include <fstream>
#include <random>

#include <nlohmann/json.hpp>

#include "tests/bench/on_device.h"
#include "tools/bench/commands.h"
#include "tools/bench/picture_file.h"
#include "tools/bench/truth.h"
#include "tools/reference/pixel.h"
#include "tools/reference/progress.h"

namespace brume::bench {
namespace {

namespace fs = std::filesystem;

// Six pixels: four of the medium, of which the last is an edge, and two without medium.
RadianceImage reference() {
    RadianceImage image{6, 1, {}, {1, 0.5f, 0.5f, 0.5f, 0.5f, 1}};
    image.radiance = {glm::vec3(9), glm::vec3(1), glm::vec3(2), glm::vec3(2), glm::vec3(4), glm::vec3(9)};
    image.edges = {1, 0, 0, 0, 1, 0};
    image.medium_alone = true;
    return image;
}

RadianceImage wrong() {
    RadianceImage image = reference();
    image.edges.clear();
    image.radiance = {glm::vec3(0), glm::vec3(1.1f), glm::vec3(2), glm::vec3(1.8f), glm::vec3(6), glm::vec3(0)};
    return image;
}

TEST(MediumError, CountsTheMediumAndApartTheEdges) {
    const MediumError error = mediumError(wrong(), reference(), {});
    EXPECT_NEAR(error.medium.relative_rmse, std::sqrt((0.01 + 0.04) / (1 + 4 + 4)), 1e-6);
    EXPECT_NEAR(error.medium.bias, (0.1 + 0 - 0.1) / 3, 1e-6);
    EXPECT_NEAR(error.edges.relative_rmse, 0.5, 1e-6);
    EXPECT_EQ(error.medium.pixels, 3u);
    EXPECT_EQ(error.edges.pixels, 1u);
    EXPECT_DOUBLE_EQ(error.edgeShare(), 0.25);
    EXPECT_TRUE(error.edges_known && error.alone);
    EXPECT_EQ(inShort(error), "7.45 %; edges 50 %, 25 % of pixels");
    EXPECT_NEAR(toJson(error)["edges"]["relative_rmse"].get<double>(), 0.5, 1e-6);
    EXPECT_EQ(describe(error).find('\n'), std::string::npos);
    EXPECT_NE(describe(error).find("edges: relative RMSE 50 %, 1 pixels"), std::string::npos) << describe(error);
}

TEST(MediumError, SaysWhatItCannotTell) {
    RadianceImage exact = reference();
    exact.edges.clear();
    MediumError error = mediumError(wrong(), exact, {});
    EXPECT_EQ(error.medium.pixels, 4u) << "edges with the others";
    EXPECT_NE(describe(error).find("render --reference"), std::string::npos) << describe(error);
    exact = reference();
    exact.medium_alone = false;
    error = mediumError(wrong(), exact, {});
    EXPECT_NE(describe(error).find("--medium-alone"), std::string::npos) << describe(error);
    exact.edges.assign(6, 0);
    error = mediumError(wrong(), exact, {});
    EXPECT_EQ(error.edges.pixels, 0u);
    EXPECT_TRUE(toJson(error)["edges"]["relative_rmse"].is_number_float()); // NaN, null in the file
    EXPECT_NE(describe(error).find("no edges"), std::string::npos);
}

// Light that bends within a pixel is four times as far off at its corners as half-way: that is no edge.
TEST(Edges, AreJumpsAndNotCurves) {
    const glm::vec3 centre(1);
    EXPECT_FALSE(reference::isEdge(centre, glm::vec3(1), glm::vec3(1)));
    EXPECT_FALSE(reference::isEdge(centre, glm::vec3(1.009f), glm::vec3(1.036f))) << "a curve";
    EXPECT_TRUE(reference::isEdge(centre, {1, 1, 1.02f}, {1, 1, 1.02f})) << "an edge across the middle, of one channel";
    EXPECT_TRUE(reference::isEdge(centre, glm::vec3(1), glm::vec3(0.875f))) << "an edge that cuts off one corner";
}

// The jackknife says how far samples of a picture are from the whole.
TEST(SamplingError, IsTheSpreadOfSamples) {
    std::mt19937 random(7);
    const auto uniform = [&] { return float(random() % 10000) / 10000; };
    const auto sample = [&](int count) {
        RadianceImage exact{count, 1, {}, std::vector<float>(size_t(count), 0.5f)}, value = exact;
        for (int i = 0; i < count; ++i) {
            const float r = 0.2f + uniform();
            exact.radiance.emplace_back(r), value.radiance.emplace_back(r + 0.05f * (uniform() - 0.4f));
        }
        exact.edges.assign(size_t(count), 0);
        return std::pair(value, exact);
    };
    const auto [all, all_exact] = sample(100'000);
    const double whole = mediumError(all, all_exact, {}).medium.relative_rmse;
    double squares = 0, said = 0;
    constexpr int kTimes = 60;
    for (int i = 0; i < kTimes; ++i) {
        const auto [value, exact] = sample(400);
        squares += std::pow(mediumError(value, exact, {}).medium.relative_rmse - whole, 2) / kTimes;
        said += samplingError(value, exact, {}) / kTimes;
    }
    EXPECT_GT(said, 0.7 * std::sqrt(squares));
    EXPECT_LT(said, 1.5 * std::sqrt(squares));
    const auto [few, few_exact] = sample(10);
    EXPECT_TRUE(std::isnan(samplingError(few, few_exact, {})));
}

TEST(Progress, SaysHowMuchTimeIsLeft) {
    EXPECT_EQ(reference::Progress::text("reference of x", 0.25, 3), "reference of x: 25 %, 9 s left");
}

TEST(PictureFile, IsWhatItsNameSaysOrRefused) {
    const fs::path here = folder("pictures");
    RadianceImage image{16, 8, std::vector<glm::vec3>(128, glm::vec3(0.5f)), std::vector<float>(128, 1.0f)};
    const auto begins = [&](const char* name) {
        writePicture(here / name, image, {});
        std::string bytes(4, '\0');
        std::ifstream(here / name, std::ios::binary).read(bytes.data(), 4);
        return bytes;
    };
    EXPECT_EQ(begins("a.jpg").substr(0, 3), "\xff\xd8\xff");
    EXPECT_EQ(begins("a.jpeg").substr(0, 3), "\xff\xd8\xff");
    EXPECT_EQ(begins("a.png"), "\x89PNG");
    EXPECT_EQ(begins("a.exr"), "\x76\x2f\x31\x01");
    for (const char* name : {"a.bmp", "a", "a.jpg.txt"}) {
        EXPECT_THROW(writePicture(here / name, image, {}), std::runtime_error);
        for (const char* format : {".exr", ".png", ".jpg"})
            EXPECT_NE(pictureRefusal(name).find(format), std::string::npos) << pictureRefusal(name);
        EXPECT_FALSE(fs::exists(here / name));
    }
    EXPECT_THROW(writePicture(here / "no" / "a.jpg", image, {}), std::runtime_error);
}

Case cloudWithABox() {
    Case wanted = smallCloud();
    wanted.scene = "props";
    wanted.set = {std::begin(kMediumAlone), std::end(kMediumAlone)};
    wanted.set.insert(wanted.set.end(), {"medium.count=60", "render.method=slabs", "render.rate=1", "render.slabs=64"});
    return wanted;
}

class ErrorOfTools : public OnDevice {};

// A pixel's reference is the ray through its centre, but of 2x2 rays where an edge crosses it.
TEST_F(ErrorOfTools, TheReferenceKnowsItsEdges) {
    Stage stage(device(), cloudWithABox());
    Truth truth(folder("edges"));
    const RadianceImage exact = truth.of(stage, stage.pose(), {48, 27});
    ASSERT_EQ(exact.edges.size(), size_t(48 * 27));
    const auto edges = size_t(std::count(exact.edges.begin(), exact.edges.end(), 1));
    EXPECT_GT(edges, 10u);
    EXPECT_LT(edges, exact.edges.size() / 4);
    EXPECT_EQ(truth.of(stage, stage.pose(), {48, 27}).edges, exact.edges) << "kept with the picture";
    const MediumError error = mediumError(stage.picture(stage.pose(), {48, 27}), exact, {});
    EXPECT_TRUE(error.alone);
    EXPECT_LT(2 * error.medium.relative_rmse, error.edges.relative_rmse);

    std::vector<glm::uvec2> some;
    for (uint32_t i = 0; i < 48 * 27; i += 7) some.emplace_back(i % 48, i / 48);
    const RadianceImage sampled = truthAt(stage, stage.pose(), {48, 27}, some, 1e9, 0);
    ASSERT_EQ(size_t(sampled.width), some.size());
    for (size_t i = 0; i < some.size(); ++i) {
        EXPECT_EQ(sampled.radiance[i], exact.radiance[7 * i]);
        EXPECT_EQ(sampled.edges[i], exact.edges[7 * i]);
    }
    EXPECT_EQ(truthAt(stage, stage.pose(), {48, 27}, some, 0, 30).width, 30) << "no time, but the least";
}

// Once the tools had four numbers for one picture.
TEST_F(ErrorOfTools, EveryToolPrintsTheSameError) {
    const fs::path here = folder("same");
    const Case wanted = cloudWithABox();
    Stage stage(device(), wanted);
    Truth truth(here);
    const MediumError direct =
        mediumError(stage.picture(stage.pose(), {45, 25}), truth.of(stage, stage.pose(), {45, 25}), {});

    Series series{.name = "s", .about = "", .scenes = {"props"}, .sizes = {"45x25"}, .error = "45x25", .variants = {}};
    series.variants.push_back({.name = "v", .set = wanted.set, .size = {}});
    const nlohmann::json rows = runSweep(device(), {series}, truth, {.seconds = 0, .least = 1, .only = ""});
    const nlohmann::json swept = rows[0]["rows"][0]["error"];
    EXPECT_DOUBLE_EQ(swept["relative_rmse"].get<double>(), direct.medium.relative_rmse);
    EXPECT_DOUBLE_EQ(swept["edges"]["relative_rmse"].get<double>(), direct.edges.relative_rmse);

    Context context;
    context.cache = here;
    RenderOptions options;
    options.wanted = wanted;
    options.size = "45x25";
    options.medium_alone = true;
    options.out = here / "value.exr";
    testing::internal::CaptureStdout();
    render(context, options);
    options.reference = true;
    options.out = here / "exact.exr";
    render(context, options);
    comparePictures({.picture = here / "value.exr", .reference = here / "exact.exr", .flip_map = {}});
    const std::string said = testing::internal::GetCapturedStdout();
    EXPECT_NE(said.find(describe(direct)), said.npos) << said << describe(direct);
}

} // namespace
} // namespace brume::bench
