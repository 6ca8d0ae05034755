// brume-bench scattering: the paths' noise is taken out of an error, a row has all models, the page counts promises.
#include "tools/bench/scattering.h"

#include <cmath>
#include <string>
#include <vector>

#include "common/random.h"
#include "tests/bench/on_device.h"
#include "tests/layer.h"

namespace brume::bench {
namespace {

// A picture of radiance 1.1 beside paths of mean radiance 1 whose standard error is 0.2.
TEST(ScatteringError, IsWithoutTheNoiseOfThePaths) {
    constexpr size_t kPixels = 4000;
    Random random(3, 0);
    RadianceImage picture{int(kPixels), 1, {}, {}};
    reference::TrackedPicture truth{int(kPixels), 1, {}, {}};
    for (size_t i = 0; i < kPixels; ++i) {
        picture.radiance.emplace_back(1.1f);
        glm::dvec3 value(1);
        for (int c = 0; c < 3; ++c) value[c] += 0.2 * std::sqrt(3.0) * double(random.uniform(-1, 1));
        truth.radiance.push_back(value), truth.standard_error.emplace_back(0.2);
    }
    const std::vector<uint8_t> all(kPixels, 1);
    const ScatteringError error = scatteringError(picture, truth, all);
    EXPECT_NEAR(error.bias, 0.1, 0.005);
    EXPECT_NEAR(error.rmse, 0.1 / std::sqrt(1.04), 0.01);
    EXPECT_NEAR(noiseOf(truth, all), 0.2 / std::sqrt(1.04), 0.002);

    std::vector<uint8_t> first(kPixels, 0);
    first[0] = 1;
    EXPECT_NEAR(scatteringError(picture, truth, first).bias,
                3.3 / (truth.radiance[0].x + truth.radiance[0].y + truth.radiance[0].z) - 1, 1e-6);
}

class Scattering : public OnDevice {};

TEST_F(Scattering, ARowHasTheErrorOfEachModel) {
    BRUME_WHOLE_LAYER_ONLY();
    ScatteringQuestion asked;
    asked.width = 32, asked.noise = 0.05, asked.seconds = 100;
    asked.folder = folder("scattering"), asked.references = folder("scattering-truth");
    const ScatteringRow row = scatteringRow(device(), builtInCosts(), asked, 3028); // four thick particles from within
    ASSERT_EQ(row.why_not, "");
    EXPECT_TRUE(row.promised);
    EXPECT_EQ(row.particles, 4u);
    EXPECT_EQ(row.objects, 0u);
    EXPECT_LT(row.noise, 1.2 * asked.noise);
    EXPECT_LT(row.errors[0].bias, -0.2); // single scattering leaves out what propagation has
    EXPECT_GT(row.errors[1].bias, 0.5);
    EXPECT_LT(std::abs(row.errors[2].bias), 0.03);
    EXPECT_LT(row.errors[2].rmse, 0.2 * row.errors[0].rmse);
}

TEST_F(Scattering, ASceneThatCannotBeMeasuredSaysWhy) {
    ScatteringQuestion asked;
    asked.width = 32;
    asked.folder = folder("scattering-fails"), asked.references = folder("scattering-truth");
    EXPECT_EQ(scatteringRow(device(), builtInCosts(), asked, 3026).why_not, "the camera sees little of the medium");
}

ScatteringRow row(uint64_t seed, size_t objects, double depth, bool promised, double rmse) {
    ScatteringRow out{.seed = seed, .layout = "ball", .camera = "far", .particles = 3, .objects = objects};
    out.depth = depth, out.albedo = 0.6, out.paths = 99, out.noise = 0.03, out.promised = promised;
    for (size_t i = 0; i < kModels.size(); ++i) out.errors[i] = {rmse / double(i + 1), -rmse};
    return out;
}

TEST(ScatteringPage, CountsTheScenesWithAPromise) {
    std::vector<ScatteringRow> rows{row(1, 0, 0.1, true, 0.02), row(2, 0, 0.2, true, 0.06), row(3, 0, 0.1, true, 0.04),
                                    row(4, 0, 5, false, 0.9), row(5, 2, 5, true, 0.3)};
    rows.push_back({.seed = 6, .layout = "ball", .camera = "far", .why_not = "too dark"});
    const std::string page = scatteringPage(rows);
    for (const char* line : {"| below 0.3 | 3 | 4 % | 6 % | -4 % | 2 % | 3 % | -4 % | 1.33 % | 2 % | -4 % |",
                             "| with objects, any | 1 | 30 % | 30 % | -30 % |",
                             "3 particles, 0 objects; no promise | 5 | 0.6 | 99 | 3 % | 90 %, -90 % |",
                             "| 6 | ball, far, 0 particles, 0 objects | 0 | 0 | not measured: too dark | | | | |"})
        EXPECT_NE(page.find(line), page.npos) << line << '\n' << page;
    EXPECT_EQ(page.find("| 3 and more |"), page.npos);
}

} // namespace
} // namespace brume::bench
