// What is measured in motion: faults that are planted are found, by the number that is theirs and by no other.
#include "tools/bench/motion.h"

#include <cmath>
#include <functional>

#include <nlohmann/json.hpp>

#include "tests/bench/on_device.h"
#include "tools/bench/motion_errors.h"
#include "tools/bench/sweep.h"

namespace brume::bench {
namespace motion_test {
namespace {

using Frames = std::vector<RadianceImage>;
constexpr int kWidth = 48, kHeight = 27, kFrames = 10;

// Two soft balls that pass one another, a bright one and a dark one; `dark_first`: which is in front.
RadianceImage balls(float time, bool dark_first = false) {
    RadianceImage image{kWidth, kHeight, {}, {}};
    const auto ball = [](float x, float y) { return 0.8f * std::exp(-(x * x + y * y) / 60); };
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float bright = ball(float(x) - 20 - 0.8f * time, float(y) - 13),
                        dark = ball(float(x) - 28 + 0.4f * time, float(y) - 12);
            const float light =
                dark_first ? 0.1f * dark + (1 - dark) * 2 * bright : 2 * bright + (1 - bright) * 0.1f * dark;
            image.radiance.emplace_back(light);
            image.transmittance.push_back(0.9f * (1 - bright) * (1 - dark));
        }
    return image;
}

Frames frames(const std::function<RadianceImage(int)>& draw) {
    Frames all;
    for (int i = 0; i < kFrames; ++i) all.push_back(draw(i));
    return all;
}

Frames truth() {
    return frames([](int i) { return balls(float(i)); });
}

RadianceImage mixed(const RadianceImage& a, float part_of_b, const RadianceImage& b) {
    RadianceImage out = a;
    for (size_t p = 0; p < out.radiance.size(); ++p)
        out.radiance[p] = (1 - part_of_b) * a.radiance[p] + part_of_b * b.radiance[p];
    return out;
}

MotionErrors errorsOf(const Frames& seen) { return motionErrors(seen, truth(), {}); }

TEST(MotionErrors, AreExactlyNothingForTheTruth) {
    const MotionErrors errors = errorsOf(truth());
    for (const double zero :
         {errors.mean, errors.deviation, errors.flicker, errors.temporal_flip, errors.lag, errors.ghost})
        EXPECT_EQ(zero, 0);
    EXPECT_EQ(errors.ratio.least, 1);
    EXPECT_EQ(errors.ratio.greatest, 1);
}

// Worked out by hand: one pixel of radiance 1, errors 0, 0.1, 0, 0.
TEST(MotionErrors, AreThoseOfTheirFormulas) {
    const auto pixel = [](float value) { return RadianceImage{1, 1, {glm::vec3(value)}, {0.5f}}; };
    const Frames seen{pixel(1), pixel(1.1f), pixel(1), pixel(1)}, exact(4, pixel(1));
    const MotionErrors errors = motionErrors(seen, exact, {});
    EXPECT_NEAR(errors.mean, 0.025, 1e-6);
    EXPECT_NEAR(errors.deviation, 0.1 * std::sqrt(3) / 4, 1e-6);
    EXPECT_EQ(errors.greatest, 1u);
    EXPECT_NEAR(errors.flicker, std::sqrt((0.04 + 0.01) / 2), 1e-6);
    EXPECT_NEAR(errors.ratio.least, 1 / 1.1, 1e-6);
    EXPECT_NEAR(errors.ratio.greatest, 1.1, 1e-6);
    EXPECT_TRUE(std::isnan(errors.lag)) << "the reference stands still";
    EXPECT_THROW(motionErrors({seen.data(), 2}, {exact.data(), 2}, {}), std::invalid_argument);
}

// A depth order that is wrong in one frame flickers more than one that is always wrong, which errs more.
TEST(MotionErrors, FlickerFindsAPop) {
    const MotionErrors popped = errorsOf(frames([](int i) { return balls(float(i), i == 5); })),
                       always = errorsOf(frames([](int i) { return balls(float(i), true); }));
    EXPECT_EQ(popped.greatest, 5u);
    EXPECT_GT(always.mean, 5 * popped.mean);
    EXPECT_GT(popped.flicker, 5 * always.flicker);
    EXPECT_GT(popped.temporal_flip, 0.01);
    EXPECT_LT(popped.ghost, 0.02);

    Frames swapped = truth();
    std::swap(swapped[4], swapped[5]);
    EXPECT_GT(errorsOf(swapped).flicker, 0.05);
}

TEST(MotionErrors, LagFindsAGhost) {
    const auto old = [](int i) { return balls(float(i - 1)); };
    const MotionErrors ghost = errorsOf(frames([&](int i) { return mixed(balls(float(i)), 0.95f, old(i)); }));
    EXPECT_NEAR(ghost.lag, 0.95, 1e-4);
    EXPECT_NEAR(ghost.ghost, 1, 1e-4);

    RadianceImage kept = balls(-20);
    for (int i = -19; i < 0; ++i) kept = mixed(balls(float(i)), 0.8f, kept);
    const MotionErrors history = errorsOf(frames([&](int i) { return kept = mixed(balls(float(i)), 0.8f, kept); }));
    EXPECT_NEAR(history.lag, 0.8 / (1 - 0.8), 1) << "the mean age of what it shows";
    EXPECT_GT(history.ghost, 0.8);
    EXPECT_LT(history.flicker, 0.1 * history.mean) << "a ghost does not flicker";
}

TEST(MotionErrors, ASteadyBiasIsNeitherFlickerNorLag) {
    const MotionErrors errors = errorsOf(frames([](int i) {
        RadianceImage image = balls(float(i));
        for (glm::vec3& pixel : image.radiance) pixel = 1.1f * pixel + 0.02f;
        return image;
    }));
    EXPECT_GT(errors.mean, 0.1);
    EXPECT_LT(errors.flicker, 0.003);
    EXPECT_NEAR(errors.lag, 0, 1e-5);
    EXPECT_LT(errors.ghost, 1e-3) << "rounding is all that is left to explain";
    EXPECT_NEAR(errors.ratio.greatest, 1, 0.003);
}

class MotionRows : public OnDevice {};

Motion fewFrames(const char* mover) {
    Motion motion;
    motion.movers = {mover};
    motion.frames = 5, motion.lead = 10, motion.light_degrees = 3, motion.degrees = 1, motion.size = {48, 27};
    return motion;
}

NamedCase caseOf(const char* name, std::vector<std::string> set) {
    NamedCase one{name, smallCloud()};
    one.wanted.set.insert(one.wanted.set.end(), set.begin(), set.end());
    return one;
}

// Light that a viewer's last pictures give lags behind the sun, and what is drawn anew does not.
TEST_F(MotionRows, HistoryLagsBehindTheSun) {
    Truth truth(folder("motion-sun"));
    const nlohmann::json rows = motionRows(
        device(),
        {caseOf("plain", {"render.method=froxels", "render.froxels.pixels=2"}),
         caseOf("history", {"render.method=froxels", "render.froxels.pixels=2", "render.froxels.history=0.9"}),
         caseOf("slabs", {"render.rate=1"})},
        fewFrames("sun"), truth);
    ASSERT_EQ(rows.size(), 3u);
    EXPECT_GT(rows[1]["lag"], 1.5) << "of up to 9 frames: extinction is of now";
    EXPECT_GT(rows[1]["ghost"], 0.3);
    EXPECT_LT(std::abs(rows[0]["lag"].get<double>()), 0.1);
    EXPECT_LT(std::abs(rows[2]["lag"].get<double>()), 0.1);
    EXPECT_GT(rows[0]["ms"]["mean"], 0);
}

// Every mover moves what it says: the picture of the first frame is not that of the last.
TEST_F(MotionRows, EachMoverMovesAndAVariantBesideItselfErrsByNothing) {
    const std::filesystem::path here = folder("motion-each");
    Truth truth(here);
    for (const char* mover : {"camera", "particles", "sun", "all"}) {
        Motion motion = fewFrames(mover);
        motion.beside = 0;
        const nlohmann::json rows =
            motionRows(device(), {caseOf("fine", {}), caseOf("dim", {"render.method=sphere"})}, motion, truth);
        for (const char* zero : {"relative_rmse", "rmse_greatest", "flicker", "temporal_flip", "lag", "ghost"})
            EXPECT_EQ(rows[0][zero], 0) << mover << ' ' << zero << ": nothing moves where lag is null";
        EXPECT_GT(rows[1]["relative_rmse"], 0) << mover;
    }
    EXPECT_TRUE(std::filesystem::is_empty(here)) << "beside a variant no reference is made";
}

TEST_F(MotionRows, TheLampGoesRoundWhereThereIsOne) {
    Truth truth(folder("motion-lamp"));
    EXPECT_THROW(motionRows(device(), {caseOf("cloud", {})}, fewFrames("lamp"), truth), SceneError);
    NamedCase one{"lamp", {}};
    one.wanted.scene = "smoke-spots";
    Motion motion = fewFrames("lamp");
    motion.beside = 0, motion.ticks = 60, motion.lead = 0, motion.frames = 3;
    EXPECT_EQ(motionRows(device(), {one}, motion, truth)[0]["lag"], 0) << "null where nothing moves";
}

TEST_F(MotionRows, AFlightHasTimesOfItsPlaces) {
    Truth truth(folder("motion-flight"));
    Motion motion = fewFrames("camera");
    motion.errors = false, motion.frames = 5, motion.places = {"20m", "inside"};
    const nlohmann::json row = motionRows(device(), {caseOf("flight", {})}, motion, truth)[0];
    ASSERT_EQ(row["places"].size(), 3u);
    uint32_t sum = 0;
    for (const nlohmann::json& place : row["places"]) {
        sum += place["frames"].get<uint32_t>();
        EXPECT_GT(place["mean"], 0);
        EXPECT_NEAR(place["variance"].get<double>(), std::pow(place["deviation"].get<double>(), 2), 1e-9);
    }
    EXPECT_EQ(sum, 5u);
    EXPECT_FALSE(row.contains("flicker"));
}

// Errors beside a variant: what that variant itself errs by is exactly nothing.
TEST_F(MotionRows, CostsBesideAVariant) {
    const std::filesystem::path here = folder("beside");
    Truth truth(here);
    Series series{.name = "s", .about = "", .scenes = {"cloud"}, .sizes = {"48x27"}, .error = "", .variants = {}};
    series.set = {"medium.count=40"};
    series.variants = {{.name = "isv", .set = {"render.method=isv"}, .size = {}},
                       {.name = "sphere", .set = {"render.method=sphere"}, .size = {}}};
    series.beside = "sphere";
    const nlohmann::json rows = runSweep(device(), {series}, truth, {.seconds = 0, .least = 1, .only = ""})[0]["rows"];
    EXPECT_GT(rows[0]["beside"]["relative_rmse"], 0.001);
    EXPECT_GT(rows[0]["beside"]["above_ten"], 0);
    EXPECT_EQ(rows[1]["beside"]["relative_rmse"], 0);
    EXPECT_EQ(rows[1]["beside"]["flip"], 0);
    EXPECT_EQ(rows[1]["beside"]["above_ten"], 0);
    EXPECT_TRUE(std::filesystem::is_empty(here)) << "no reference is made";
}

} // namespace
} // namespace motion_test
} // namespace brume::bench
