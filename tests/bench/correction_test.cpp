// brume-bench correction: laws that turn wrong coarsen the pictures, measuring mends that, and the page says when.
#include "tools/bench/correction.h"

#include "tests/bench/on_device.h"
#include "tests/layer.h"

namespace brume::bench {
namespace {

class Correction : public OnDevice {};

CorrectionQuestion question() {
    CorrectionQuestion asked;
    asked.wanted.set = {"render.flip=1"};
    asked.wanted.size = {160, 90};
    asked.law_factor = 0.05;
    asked.at = 1, asked.seconds = 300, asked.measure_error = 1;
    return asked;
}

// Where the laws are right they are above the error, or little below it. Afterwards they are twenty times as small.
bool wrong(const CorrectionSample& sample) { return sample.measured.law < sample.measured.rmse / 3; }

// The plan predicts what is measured all the same: within the bounds, or nearly.
bool corrected(const CorrectionSample& sample) { return sample.predicted > sample.measured.low / 1.5; }

// A loaded machine measures slowly, so the run ends with what it is for and not at a time.
TEST_F(Correction, LawsThatTurnWrongAreSeenAndMended) {
    BRUME_WHOLE_LAYER_ONLY();
    CorrectionQuestion asked = question();
    asked.done = [](const CorrectionRun& run) {
        const CorrectionTimes times = timesOf(run);
        return run.samples.size() >= 4 && times.last && wrong(*times.last) && corrected(*times.last);
    };
    const CorrectionRun run = correctionRun(device(), builtInCosts(), asked);
    EXPECT_NEAR(run.promised, 0.005, 1e-6);
    EXPECT_GE(run.broken_s, 1);
    EXPECT_GT(run.frames, 0u);
    ASSERT_GE(run.samples.size(), 4u);
    EXPECT_EQ(run.samples.front().s, 0);
    for (size_t i = 1; i < run.samples.size(); ++i) EXPECT_GE(run.samples[i].s - run.samples[i - 1].s, 0.5);
    const CorrectionTimes times = timesOf(run);
    ASSERT_TRUE(times.before && times.last);
    EXPECT_FALSE(wrong(*times.before));
    EXPECT_TRUE(wrong(*times.last));
    EXPECT_TRUE(corrected(*times.last));
    EXPECT_NE(correctionPage(run).find("| at the end | " + times.last->way), std::string::npos);
}

TEST_F(Correction, AMethodThatTheSceneNamesPromisesNothing) {
    CorrectionQuestion asked = question();
    asked.wanted.set.emplace_back("render.method=slabs");
    EXPECT_THROW(correctionRun(device(), builtInCosts(), asked), SceneError);
}

CorrectionSample sample(double s, const char* way, double slabs, double measured, size_t pixels = 200) {
    const ErrorEstimate error{
        .pixels = pixels, .rmse = measured, .low = measured / 1.2, .high = measured * 1.2, .bias = 0, .law = 0.001};
    return {s, way, 12, slabs, 0.004, error};
}

TEST(CorrectionPage, SaysWhenTheErrorWasAboveTheBudgetAndWhenNoLonger) {
    CorrectionRun run{.promised = 0.005, .broken_s = 1.25, .frames = 90, .samples = {}};
    run.samples = {sample(0, "fine", 24, 0.003),    sample(1, "fine", 24, 0.0051),   sample(1.4, "fine", 24, 0.0051),
                   sample(1.5, "coarse", 8, 0, 99), sample(2, "coarse", 8, 0.008),   sample(2.5, "coarse", 8, 0.0121),
                   sample(3, "finer", 32, 0.004),   sample(3.5, "finer", 32, 0.0052)};
    const std::string page = correctionPage(run);
    for (const char* line :
         {"first above the budget 0.8 s after", "At worst it was 1.2 %, after 1.2 s.",
          "**After 1.8 s it was within the budget again.** Of the 2 samples from then on 1 were above it.",
          "| before | fine | 0.4 % | 0.51 % (0.43 to 0.61) |", "| at worst | coarse | 0.4 % | 1.2 % (1 to 1.5) |",
          "| at the end | finer | 0.4 % | 0.52 % (0.43 to 0.62) |", "| 0.2 | coarse | 0.4 % | not known yet |",
          "| 1.8 | finer |", "8 samples of 90 frames"})
        EXPECT_NE(page.find(line), page.npos) << line << '\n' << page;
    const std::string plot = correctionPlot(run);
    const auto count = [](const std::string& text, const char* what) {
        size_t found = 0;
        for (size_t at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++found;
        return found;
    };
    EXPECT_EQ(count(plot, "<circle"), 7u + 8u + 8u); // what is not known has no point
    EXPECT_EQ(count(plot, "stroke-opacity"), 7u);    // only what is measured has bounds
    EXPECT_EQ(count(settingsPlot(run), "<circle"), 8u + 8u);

    run.samples.resize(6);
    EXPECT_NE(correctionPage(run).find("not within the budget again before the run ended"), page.npos);
    run.samples.resize(2);
    EXPECT_NE(correctionPage(run).find("never was above the budget"), page.npos);
}

} // namespace
} // namespace brume::bench
