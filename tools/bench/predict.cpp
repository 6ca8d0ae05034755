#include "tools/bench/predict.h"

#include <algorithm>
#include <cstdio>

#include <fmt/format.h>

#include "server/effects/shadow_volume/shadow_volume_plan.h"
#include "server/plan/planner.h"
#include "tools/bench/error.h"

namespace brume::bench {
namespace {

struct Sample {
    const char *scene, *camera, *method;
    uint32_t rate, slabs;
    glm::uvec2 size;
    const char* scattering = "single";
};
// Few large and many small particles, from outside and within, with and without objects. Methods that draw get small
// pictures: a fragment costs the same.
constexpr Sample kSamples[] = {
    {"cloud", "outside", "slabs", 8, 32, {640, 360}},
    {"cloud", "inside", "slabs", 16, 24, {640, 360}},
    {"cloud-5000", "outside", "slabs", 8, 32, {640, 360}},
    {"cloud-5000", "inside", "slabs", 16, 24, {640, 360}},
    {"plume", "outside", "slabs", 4, 96, {640, 360}},
    {"props", "outside", "slabs", 8, 32, {640, 360}},
    {"cloud", "outside", "grid", 8, 32, {640, 360}},
    {"cloud-5000", "inside", "grid", 16, 24, {640, 360}},
    {"props", "outside", "grid", 8, 32, {640, 360}},
    {"cloud-5000", "outside", "grid", 8, 32, {640, 360}},
    {"cloud", "outside", "sphere", 0, 0, {320, 180}},
    {"cloud-5000", "inside", "sphere", 0, 0, {96, 54}},
    {"plume", "outside", "sphere", 0, 0, {320, 180}},
    {"cloud", "outside", "isv", 0, 0, {320, 180}},
    {"cloud-5000", "inside", "isv", 0, 0, {96, 54}},
    {"cloud", "outside", "tiles", 0, 0, {640, 360}},
    {"cloud-5000", "outside", "tiles", 0, 0, {640, 360}},
    {"plume", "outside", "tiles", 0, 0, {640, 360}},
    {"cloud", "outside", "slabs", 8, 32, {640, 360}, "propagation"},
    {"stage", "outside", "slabs", 8, 32, {640, 360}},
    {"lamp", "outside", "slabs", 4, 32, {640, 360}},
    {"glass", "outside", "slabs", 4, 48, {640, 360}},
    {"tetrahedra", "outside", "tetrahedra", 0, 0, {320, 180}},
};

// The passes of the frame that took the least time: whatever else the machine does only adds to it. A CPU driver runs
// passes later than it says, so that the least of each pass would be what its neighbours had taken over.
std::vector<FrameCost::Pass> passesOf(Stage& stage, double seconds) {
    stage.frame(); // compiles shaders, fits buffers
    const auto sumOf = [](const FrameCost& frame) {
        double ms = 0;
        for (const FrameCost::Pass& pass : frame.passes) ms += pass.ms;
        return ms;
    };
    FrameCost least;
    double spent = 0;
    for (int frames = 0; frames < 3 || spent < seconds; ++frames) {
        FrameCost frame = stage.frame();
        spent += frame.wall_ms * 1e-3;
        if (frames == 0 || sumOf(frame) < sumOf(least)) least = std::move(frame);
    }
    return least.passes;
}

// What one sample took: of the shared passes, each; of the view's, their sum.
struct Timed {
    Work shared, view;
    std::array<double, kMostCosts> shared_ms{};
    double view_ms = 0;
};

Timed timed(Stage& stage, glm::uvec2 size, double seconds) {
    const PlanScene scene = planScene(stage.scene(), stage.simulation());
    const RenderSettings& settings = stage.scene().render;
    Timed out;
    out.shared = sharedWork(scene, settings);
    out.shared += shadowWork(scene, scene.shadows.front());
    out.view = ViewWork(scene, {stage.pose(), size.x, size.y}).of(settings);
    for (const FrameCost::Pass& pass : passesOf(stage, seconds)) {
        if (!pass.shared) out.view_ms += pass.ms;
        for (size_t i = 0; i < allCosts().size(); ++i)
            if (pass.shared && pass.name == allCosts()[i]->pass) out.shared_ms[i] += pass.ms;
    }
    return out;
}

// Constants with which the samples' sums come out right, as close as may be to those it starts from: each round
// multiplies every constant by how much longer the samples took than predicted, weighted by its part in them. It stays
// positive.
void fitViews(const std::vector<Timed>& samples, CostModel& model) {
    for (int round = 0; round < 20; ++round) {
        std::array<double, kMostCosts> weight{}, ratio{};
        for (const Timed& sample : samples) {
            double predicted = 0;
            for (size_t i = 0; i < allCosts().size(); ++i) predicted += sample.view[i] * model.ns[i] * 1e-6;
            for (size_t i = 0; i < allCosts().size(); ++i) {
                const double part = sample.view[i] * model.ns[i] * 1e-6 / predicted;
                weight[i] += part;
                ratio[i] += part * sample.view_ms / predicted;
            }
        }
        for (size_t i = 0; i < allCosts().size(); ++i)
            if (weight[i] > 0 && ratio[i] > 0) model.ns[i] *= ratio[i] / weight[i];
    }
}

// Views that the constants of the error laws come from.
bool fitted(const std::string& scene, const std::string& camera) {
    return (scene == "cloud" || scene == "cloud-5000" || scene == "tubes" || scene == "props") &&
           (camera == "outside" || camera == "inside");
}

// Of several views: the least and the most of measured over predicted.
struct Ratios {
    double least = 1e30, most = 0;
    void add(double ratio) { least = std::min(least, ratio), most = std::max(most, ratio); }
    std::string text() const { return most > 0 ? fmt::format("{:.2f} to {:.2f}", least, most) : "none"; }
};

} // namespace

CostModel calibrate(const gpu::Device& device, double seconds) {
    CostModel model = builtInCosts();
    std::vector<Timed> samples;
    std::array<double, kMostCosts> ms{}, units{};
    for (const Sample& sample : kSamples) {
        Case wanted{.scene = sample.scene, .set = {}, .camera = sample.camera, .size = sample.size};
        wanted.set.push_back(std::string("render.method=") + sample.method);
        wanted.set.push_back(std::string("render.scattering=") + sample.scattering);
        if (sample.rate) wanted.set.push_back("render.rate=" + std::to_string(sample.rate));
        if (sample.slabs) wanted.set.push_back("render.slabs=" + std::to_string(sample.slabs));
        Stage stage(device, wanted);
        samples.push_back(timed(stage, sample.size, seconds / double(std::size(kSamples))));
        for (size_t i = 0; i < allCosts().size(); ++i)
            ms[i] += samples.back().shared_ms[i], units[i] += samples.back().shared[i];
    }
    for (size_t i = 0; i < allCosts().size(); ++i)
        if (ms[i] > 0 && units[i] > 0) model.ns[i] = 1e6 * ms[i] / units[i];
    fitViews(samples, model);
    for (size_t s = 0; s < samples.size(); ++s) {
        double predicted = 0;
        for (size_t i = 0; i < allCosts().size(); ++i) predicted += samples[s].view[i] * model.ns[i] * 1e-6;
        std::fprintf(stderr, "  %-11s %-8s %-7s %4u x %-4u view %9.3f ms, fitted %9.3f ms\n", kSamples[s].scene,
                     kSamples[s].camera, kSamples[s].method, kSamples[s].size.x, kSamples[s].size.y, samples[s].view_ms,
                     predicted);
    }
    model.source = "calibrated now";
    model.calibrated = true;
    return model;
}

std::string planTable(const gpu::Device& device, const CostModel& model, Truth& truth, const PlanTable& wanted) {
    std::string out = "| scene, camera | fitted | plan | shared, ms | measured | ratio | view, ms | measured | "
                      "ratio | error, % | measured | ratio | FLIP | measured | ratio | at edges, % | of pixels, % "
                      "|\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    constexpr glm::uvec2 kSize{640, 360};
    constexpr uint32_t kEvery = 5; // of the pixels compared
    Ratios errors_of[2], flips_of[2], times_of;
    for (const std::string& name : wanted.scenes)
        for (const std::string& camera : wanted.cameras) {
            Case view{.scene = name, .set = {std::begin(kMediumAlone), std::end(kMediumAlone)}, .camera = camera};
            view.set.insert(view.set.end(), wanted.set.begin(), wanted.set.end());
            Stage stage(device, view, 0, model);
            double shared = 0, each = 0;
            for (const FrameCost::Pass& pass : passesOf(stage, 0.5)) (pass.shared ? shared : each) += pass.ms;
            const RadianceImage exact = truth.of(stage, stage.pose(), kSize, kEvery);
            const MediumError error = mediumError(thinned(stage.picture(stage.pose(), kSize), kEvery), exact,
                                                  displayOf(stage.scene().render));
            const Candidate& c = stage.plan().chosen;
            const double measured[] = {shared, each, error.medium.relative_rmse, error.medium.flip};
            const double predicted[] = {c.shared_ms, c.views_ms, c.error, c.flip};
            const bool fit = fitted(name, camera);
            out += fmt::format("| {}, {} | {} | {} |", name, camera, fit ? "yes" : "no", wayText(c.settings));
            constexpr int kDigits[] = {1, 1, 3, 4};
            for (int i = 0; i < 4; ++i) {
                const double unit = i == 2 ? 100 : 1, ratio = measured[i] / predicted[i];
                out += fmt::format(" {:.{}f} | {:.{}f} | {:.2f} |", unit * predicted[i], kDigits[i], unit * measured[i],
                                   kDigits[i], ratio);
                (i < 2 ? times_of : i == 2 ? errors_of[fit] : flips_of[fit]).add(ratio);
            }
            out += error.edges.pixels > 0
                       ? fmt::format(" {:.3g} | {:.1f} |\n", 100 * error.edges.relative_rmse, 100 * error.edgeShare())
                       : " - | 0 |\n";
            std::fprintf(stderr, "  %-11s %-8s error %.3f %%, measured %s\n", name.c_str(), camera.c_str(),
                         100 * c.error, inShort(error).c_str());
        }
    return out + fmt::format("\nMeasured over predicted: times {}; error {} on the views that the laws were fitted on, "
                             "{} on the others; FLIP {} and "
                             "{}. Error, FLIP and edges as docs/conventions.md defines them.\n",
                             times_of.text(), errors_of[1].text(), errors_of[0].text(), flips_of[1].text(),
                             flips_of[0].text());
}

} // namespace brume::bench
