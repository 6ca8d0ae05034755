// brume-bench which: what it recommends holds, can be pasted, and is measured as everywhere else.
#include "tools/bench/which.h"

#include <fstream>

#include "tests/bench/on_device.h"
#include "tests/layer.h"
#include "tools/bench/error.h"
#include "tools/bench/truth.h"

namespace brume::bench {
namespace {

class Which : public OnDevice {};

Question small(double error) {
    Question question;
    question.wanted = smallCloud();
    question.wanted.size = {96, 54};
    question.error = error;
    question.seconds = 100;
    return question;
}

std::string linesOf(const std::string& text) {
    const size_t from = text.find("```toml\n") + 8;
    return text.substr(from, text.find("```", from) - from);
}

TEST_F(Which, RecommendsWhatHoldsAndCanBePasted) {
    BRUME_WHOLE_LAYER_ONLY();
    const Question question = small(0.02);
    const Answers answers = which(device(), builtInCosts(), question);
    ASSERT_TRUE(answers.best && answers.holds);
    const Answer& best = answers.all[*answers.best];
    for (const Answer& answer : answers.all) {
        if (answer.holds(question.error)) {
            EXPECT_LE(best.ms(), answer.ms()) << answer.text;
        }
        EXPECT_TRUE(answer.measured || !answer.why_not.empty()) << answer.text;
    }
    const std::string text = whichText(question, answers);
    for (const char* method : {"| slabs", "| grid", "| tiles", "| sphere", "| isv", "not predicted", "96x54"})
        EXPECT_NE(text.find(method), text.npos) << method << '\n' << text;

    // Its lines in a scene's file give the picture that was measured.
    const std::filesystem::path file = folder("which") / "pasted.toml";
    std::ofstream(file) << linesOf(text) << "[medium]\ncount = 40\n[[light]]\nto_light = [0.8, 0.55, 0.15]\n";
    const Scene pasted = sceneOf({.scene = file, .set = {}});
    EXPECT_EQ(std::string(pasted.render.method), best.text.substr(0, best.text.find(',')));
    Case again = question.wanted;
    again.set.insert(again.set.end(), best.set.begin(), best.set.end());
    again.set.insert(again.set.end(), std::begin(kMediumAlone), std::end(kMediumAlone));
    Stage stage(device(), again);
    EXPECT_EQ(stage.scene().render.method, pasted.render.method);
    EXPECT_EQ(stage.scene().render.rate, pasted.render.rate);
    EXPECT_EQ(stage.scene().render.slabs, pasted.render.slabs);
    Truth truth(folder("which-truth"));
    const MediumError error = mediumError(stage.picture(stage.pose(), again.size),
                                          truth.of(stage, stage.pose(), again.size), displayOf(stage.scene().render));
    EXPECT_NEAR(error.medium.relative_rmse, best.error, 3 * best.uncertainty + 0.1 * best.error);
}

TEST_F(Which, SaysSoIfNothingHoldsAndGivesTheBest) {
    const Question question = small(1e-5);
    const Answers answers = which(device(), builtInCosts(), question);
    ASSERT_TRUE(answers.best);
    EXPECT_FALSE(answers.holds);
    for (const Answer& answer : answers.all) EXPECT_GE(answer.error, answers.all[*answers.best].error) << answer.text;
    EXPECT_NE(whichText(question, answers).find("No candidate holds 0.001 %. The best leaves "), std::string::npos);
}

// The reference scatters once: what scatters on would be taken for an error.
TEST_F(Which, LeavesOutWhatScattersMoreThanOnceAndSaysSo) {
    Question question = small(0.05);
    question.wanted.set.insert(question.wanted.set.end(), {"render.scattering=propagation", "sky.lights=true"});
    const Answers answers = which(device(), builtInCosts(), question);
    ASSERT_TRUE(answers.best);
    EXPECT_TRUE(answers.holds) << answers.all[*answers.best].error;
    const std::string text = whichText(question, answers);
    EXPECT_NE(text.find("light that scattered once"), std::string::npos) << text;
    EXPECT_EQ(linesOf(text).find("scattering"), std::string::npos) << "the scene keeps its own";
    EXPECT_EQ(whichText(small(0.05), Answers{}).find("scattered once"), std::string::npos);
}

TEST_F(Which, EndsInTimeAndSaysWhatItLeftOut) {
    Question question = small(0.02);
    question.seconds = 1e-3;
    const Answers answers = which(device(), builtInCosts(), question);
    for (const Answer& answer : answers.all) {
        EXPECT_FALSE(answer.measured);
        EXPECT_EQ(answer.why_not, "no time was left");
    }
    EXPECT_NE(whichText(question, answers).find("--seconds"), std::string::npos);
}

TEST_F(Which, RefusesACameraThatSeesNothing) {
    Question question = small(0.02);
    question.wanted.camera = "0,0,100:0,0,200";
    EXPECT_THROW(which(device(), builtInCosts(), question), std::runtime_error);
}

} // namespace
} // namespace brume::bench
