#include "tools/bench/which.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <random>
#include <span>

#include <fmt/format.h>

#include "common/settings.h"
#include "server/methods/plans.h"
#include "tools/bench/error.h"
#include "tools/bench/truth.h"

namespace brume::bench {
namespace {

constexpr size_t kMostPixels = 4000, kLeastPixels = 200; // compared
constexpr double kReferencePart = 0.3;                   // of the seconds
// A way is not measured if it is predicted to take so many times the cheapest's time, and longer than this.
constexpr double kTooDear = 40, kDearMs = 500;
constexpr int kTries = 4;     // budgets tried for a method whose error is predicted
constexpr double kRoom = 0.7; // of the error: what leaves more may be had cheaper
constexpr int kRounds = 10;   // of frames of all that hold, unless they take longer than this
constexpr double kRoundsSeconds = 3;

// The value of a setting as text; nothing for a type that no method has.
struct AsText {
    bool quoted;
    template <class T>
    std::string operator()(T* member) const {
        if constexpr (std::is_same_v<T, float> || std::is_same_v<T, uint32_t> || std::is_same_v<T, bool>)
            return fmt::format("{}", *member);
        else if constexpr (std::is_same_v<T, std::string>)
            return quoted ? '"' + *member + '"' : *member;
        return {};
    }
};

// The same as a table of TOML: numbers as they are, words quoted.
std::string tomlOf(std::span<const std::string> set) {
    std::string text = "[render]\n";
    for (const std::string& one : set) {
        const size_t equals = one.find('=');
        const std::string key = one.substr(std::string_view("render.").size(), equals - 7),
                          value = one.substr(equals + 1);
        const bool number =
            value.find_first_not_of("0123456789.e-+") == value.npos || value == "true" || value == "false";
        text += key + " = " + (number ? value : '"' + value + '"') + '\n';
    }
    return text;
}

class Search {
public:
    Search(const gpu::Device& device, const CostModel& model, const Question& question)
        : device_(device), model_(model), question_(question) {
        std::vector<std::string>& set = question_.wanted.set;
        answers_.scatters_on = sceneOf(question.wanted).render.scattering != "single";
        if (answers_.scatters_on) set.insert(set.end(), {"render.scattering=single", "sky.lights=false"});
        set.insert(set.end(), std::begin(kMediumAlone), std::end(kMediumAlone));
    }

    Answers run() {
        Case open = question_.wanted;
        open.set.emplace_back("render.method=auto");
        const Scene scene = sceneOf(open);
        Stage first(device_, withBudget(open), question_.ticks, model_);
        inputs_.scene = planScene(first.scene(), first.simulation());
        inputs_.scene.wanted.method = kAutoMethod;
        inputs_.methods = allMethods();
        inputs_.views = {{first.pose(), question_.wanted.size.x, question_.wanted.size.y}};
        wanted_ = scene.render;
        takeReference(first);
        const Plan all = planFor(kAutoMethod, question_.error);
        cheapest_ms_ = all.chosen.ms();
        answers_.refused = all.refused;
        std::vector<std::pair<std::string, Answer>> predicted; // by method
        for (const Candidate& one : candidates(all)) {         // each once, before any has a second try
            answers_.all.push_back(measured(one));
            if (one.predicted) predicted.emplace_back(one.settings.method, answers_.all.back());
        }
        for (const auto& [method, answer] : predicted) tryAgain(method, answer);
        finish();
        return answers_;
    }

private:
    using Clock = std::chrono::steady_clock;
    double seconds() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }

    // FLIP does not bind: the question is one of relative RMSE.
    Case withBudget(Case wanted) const {
        wanted.set.push_back(fmt::format("render.error={}", float(question_.error)));
        wanted.set.emplace_back("render.flip=1");
        return wanted;
    }

    Plan planFor(const std::string& method, double error) {
        inputs_.scene.wanted.method = method;
        inputs_.scene.wanted.error = float(error);
        inputs_.scene.wanted.flip = 1;
        return makePlan(inputs_, model_);
    }

    // One for each method whose error is predicted, all for the others; the cheapest first.
    std::vector<Candidate> candidates(const Plan& plan) {
        std::vector<Candidate> some{plan.chosen};
        for (const Candidate& other : plan.others) {
            const auto same = [&](const Candidate& c) { return c.settings.method == other.settings.method; };
            if (!other.predicted || std::none_of(some.begin(), some.end(), same)) some.push_back(other);
        }
        for (Candidate& c : some) // plan.others has the first rate of a method, this has the best
            if (c.predicted) c = planFor(c.settings.method, question_.error).chosen;
        std::ranges::stable_sort(some, {}, [](const Candidate& c) { return std::pair(!c.predicted, c.ms()); });
        return some;
    }

    // A random sample of the pixels that show the medium.
    void takeReference(Stage& stage) {
        const glm::uvec2 size = question_.wanted.size;
        const RadianceImage seen = stage.picture(stage.pose(), size);
        const std::vector<uint8_t> mask = mediumMask(seen, 5e-4f); // a little more than what the reference will show
        for (uint32_t y = 0; y < size.y; ++y)
            for (uint32_t x = 0; x < size.x; ++x)
                if (mask[size_t(y) * size.x + x]) pixels_.emplace_back(x, y);
        if (pixels_.empty()) throw std::runtime_error("the camera sees no medium; name another with --camera");
        std::mt19937 random(1); // the same pixels each time
        for (size_t i = pixels_.size() - 1; i > 0; --i) std::swap(pixels_[i], pixels_[random() % (i + 1)]);
        const size_t all = pixels_.size();
        pixels_.resize(std::min(all, kMostPixels));
        exact_ = truthAt(stage, stage.pose(), size, pixels_, kReferencePart * question_.seconds, kLeastPixels);
        pixels_.resize(size_t(exact_.width));
        sampled_ = pixels_.size() < all;
    }

    // Looks for the method's cheapest way that holds: budgets follow from what was measured, as predictions are bounds.
    void tryAgain(const std::string& method, Answer last) {
        double budget = question_.error;
        for (int i = 1; i < kTries && last.measured; ++i) {
            const double relative = (last.error + 2 * last.uncertainty) / question_.error;
            if (relative <= 1 && relative > kRoom) return;
            budget *= std::clamp(0.9 / relative, 0.3, 3.0);
            const Candidate candidate = planFor(method, budget).chosen;
            if (wayText(candidate.settings) == last.text) return;
            last = measured(candidate);
            if (last.measured) answers_.all.push_back(last);
        }
    }

    // Of each method whose error is predicted, several ways may have been tried.
    void keepTheBest() {
        std::vector<Answer> kept;
        for (const Answer& answer : answers_.all) {
            const auto same = std::ranges::find_if(kept, [&](const Answer& one) {
                return one.method == answer.method && one.predicted && answer.predicted;
            });
            if (same == kept.end())
                kept.push_back(answer);
            else if (better(answer, *same))
                *same = answer;
        }
        answers_.all = kept;
    }

    bool better(const Answer& a, const Answer& b) const {
        const auto rank = [&](const Answer& one) {
            const bool holds = one.holds(question_.error);
            return std::tuple(!one.measured, !holds, holds ? one.ms() : one.error);
        };
        return rank(a) < rank(b);
    }

    Answer measured(const Candidate& candidate) {
        RenderSettings settings = candidate.settings; // budgets mean nothing where nothing is left open
        settings.error = wanted_.error, settings.flip = wanted_.flip;
        Answer answer{.method = settings.method,
                      .text = wayText(settings),
                      .set = changes(wanted_, settings),
                      .why_not = {},
                      .edges = {}};
        if (candidate.predicted) answer.predicted = candidate.error;
        answer.predicted_ms = candidate.ms();
        const bool dear = candidate.ms() > kTooDear * cheapest_ms_ && candidate.ms() > kDearMs;
        if (dear) answer.why_not = fmt::format("{:.0f} times the time predicted", candidate.ms() / cheapest_ms_);
        if (seconds() > question_.seconds) answer.why_not = "no time was left";
        if (!answer.why_not.empty()) return answer;
        std::fprintf(stderr, "  %s ... %.0f s left at most\n", answer.text.c_str(),
                     std::max(0.0, question_.seconds - seconds()));

        Case wanted = question_.wanted;
        wanted.set.insert(wanted.set.end(), answer.set.begin(), answer.set.end());
        auto stage = std::make_unique<Stage>(device_, wanted, question_.ticks, model_);
        const RadianceImage picture = stage->picture(stage->pose(), wanted.size);
        RadianceImage value{exact_.width, 1, {}, {}};
        for (const glm::uvec2 at : pixels_) {
            const size_t i = size_t(at.y) * wanted.size.x + at.x;
            value.radiance.push_back(picture.radiance[i]), value.transmittance.push_back(picture.transmittance[i]);
        }
        value.medium_alone = picture.medium_alone;
        const MediumError error = mediumError(value, exact_, {});
        answer.measured = true;
        answer.error = error.medium.relative_rmse, answer.uncertainty = sampled_ ? samplingError(value, exact_, {}) : 0;
        if (error.edges.pixels > 0) answer.edges = fmt::format("{:.2g}", 100 * error.edges.relative_rmse);
        answers_.pixels = error.medium.pixels, answers_.edge_pixels = error.edges.pixels;
        stage->frame(); // fits buffers
        addFrame(*stage, answer);
        if (answer.holds(question_.error)) stages_[answer.text] = std::move(stage);
        return answer;
    }

    static void addFrame(Stage& stage, Answer& answer) {
        double shared = 0, view = 0;
        for (const FrameCost::Pass& pass : stage.frame().passes) (pass.shared ? shared : view) += pass.ms;
        answer.view_ms = std::min(answer.view_ms, view), answer.shared_ms = std::min(answer.shared_ms, shared);
    }

    // Frames of all answers that hold, in turns: what disturbs the machine disturbs all alike.
    void timeInTurns() {
        const double begin = seconds();
        for (int round = 0; round < kRounds && seconds() - begin < kRoundsSeconds; ++round)
            for (Answer& answer : answers_.all)
                if (const auto stage = stages_.find(answer.text); stage != stages_.end())
                    addFrame(*stage->second, answer);
    }

    void finish() {
        timeInTurns();
        keepTheBest();
        std::vector<Answer>& all = answers_.all;
        std::ranges::stable_sort(
            all, {}, [](const Answer& a) { return std::pair(!a.measured, a.measured ? a.ms() : a.predicted_ms); });
        for (size_t i = 0; i < all.size(); ++i)
            if (all[i].measured && (!answers_.best || better(all[i], all[*answers_.best]))) answers_.best = i;
        answers_.holds = answers_.best && all[*answers_.best].holds(question_.error);
        answers_.seconds = seconds();
    }

    const gpu::Device& device_;
    const CostModel& model_;
    Question question_;
    const Clock::time_point begin_ = Clock::now();
    PlanInputs inputs_;
    RenderSettings wanted_; // the scene's
    std::vector<glm::uvec2> pixels_;
    RadianceImage exact_;
    bool sampled_ = false; // True: not all pixels of the medium are compared
    double cheapest_ms_ = 0;
    Answers answers_;
    std::map<std::string, std::unique_ptr<Stage>> stages_; // by the text of answers that hold
};

} // namespace

std::vector<std::string> changes(RenderSettings from, RenderSettings to) {
    std::vector<std::string> set;
    for (const SceneSetting& setting : sceneSettings()) {
        if (!setting.path.starts_with("render.")) continue;
        const auto text = [&](RenderSettings& of) {
            return std::visit(AsText{false}, setting.member({.render = &of}));
        };
        if (text(from) != text(to)) set.push_back(std::string(setting.path) + '=' + text(to));
    }
    return set;
}

Answers which(const gpu::Device& device, const CostModel& model, const Question& question) {
    return Search(device, model, question).run();
}

std::string whichLegend() {
    return "Error: relative RMSE of the medium's pixels that no edge crosses, and apart of those at edges, as "
           "docs/conventions.md defines them; ± two standard errors, where not all pixels are compared. A way holds if "
           "its error and two standard errors are within. Times: least of some frames, of a view and of what all "
           "viewers share. Compare them only with each other: other programs may have run beside.\n\n";
}

std::string whichText(const Question& question, const Answers& answers) {
    const Case& wanted = question.wanted;
    std::string out = fmt::format("## {}, {}, {}x{}, within {:.3g} %\n\n", wanted.scene, wanted.camera, wanted.size.x,
                                  wanted.size.y, 100 * question.error);
    out += "| way | predicted, % | measured, % | holds | at edges, % | ms a view | ms shared |\n"
           "|---|---|---|---|---|---|---|\n";
    for (const Answer& a : answers.all) {
        const std::string predicted = a.predicted ? fmt::format("{:.2g}", 100 * *a.predicted) : "not predicted";
        if (a.measured)
            out += fmt::format("| {} | {} | {:.3g}{} | {} | {} | {:.2f} | {:.2f} |\n", a.text, predicted, 100 * a.error,
                               a.uncertainty > 0 ? fmt::format(" ± {:.1g}", 200 * a.uncertainty) : "",
                               a.holds(question.error) ? "yes" : "no", a.edges.empty() ? "-" : a.edges, a.view_ms,
                               a.shared_ms);
        else
            out += fmt::format("| {} | {} | not measured: {} | | | {:.0f} predicted | |\n", a.text, predicted,
                               a.why_not, a.predicted_ms);
    }
    out +=
        fmt::format("\nCompared: {} pixels, and {} at edges. Took {:.0f} s.{}\n\n", answers.pixels, answers.edge_pixels,
                    answers.seconds, answers.refused.empty() ? "" : " Refused: " + answers.refused + '.');
    if (answers.scatters_on)
        out += "Of light that scattered once: what scatters on is left out, and has errors of its own.\n\n";
    if (!answers.best) return out + "Nothing was measured: give it more time with --seconds.\n\n";
    const Answer& best = answers.all[*answers.best];
    out += answers.holds ? fmt::format("The cheapest within {:.3g} %", 100 * question.error)
                         : fmt::format("No candidate holds {:.3g} %. The best leaves {:.3g} %", 100 * question.error,
                                       100 * best.error);
    return out + ", for the scene's file:\n\n```toml\n" + tomlOf(best.set) + "```\n\n";
}

} // namespace brume::bench
