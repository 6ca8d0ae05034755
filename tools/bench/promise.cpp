#include "tools/bench/promise.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <set>

#include <fmt/format.h>

#include "common/random.h"
#include "server/methods/plans.h"
#include "server/methods/rays/ray_plan.h"
#include "tools/bench/error.h"
#include "tools/bench/truth.h"
#include "tools/bench/which.h"
#include "tools/random_scene/random_scene.h"

namespace brume::bench {
namespace {

using nlohmann::json;

constexpr uint64_t kTrained = 110; // last seed on which constants of laws were chosen
constexpr size_t kLeastPixels = 150;
constexpr double kFramesSeconds = 1; // of frames for the time of one way

// A random sample of the medium's pixels, evenly over the picture: one of each run of neighbours along a curve through
// all of them. In random order, so that any first part of it is a sample, too.
std::vector<glm::uvec2> sampleOf(const RadianceImage& picture, size_t most, Random random) {
    const std::vector<uint8_t> mask = mediumMask(picture, 5e-4f); // a little more than what the reference will show
    std::vector<std::pair<uint64_t, glm::uvec2>> along;           // by Morton code
    for (uint32_t i = 0; i < mask.size(); ++i) {
        if (!mask[i]) continue;
        const glm::uvec2 at(i % uint32_t(picture.width), i / uint32_t(picture.width));
        uint64_t code = 0;
        for (uint32_t bit = 0; bit < 13; ++bit)
            code |= uint64_t(at.x >> bit & 1) << (2 * bit) | uint64_t(at.y >> bit & 1) << (2 * bit + 1);
        along.emplace_back(code, at);
    }
    std::ranges::sort(along, {}, [](const auto& one) { return one.first; });
    std::vector<glm::uvec2> sample;
    const size_t count = std::min(most, along.size());
    for (size_t i = 0; i < count; ++i) {
        const size_t first = i * along.size() / count, end = (i + 1) * along.size() / count;
        sample.push_back(along[first + random.bits() % (end - first)].second);
    }
    for (size_t i = sample.size(); i-- > 1;) std::swap(sample[i], sample[random.bits() % (i + 1)]);
    return sample;
}

// The deviation (m) below which particles have this part of the optical mass.
double deviationAt(const PlanScene& scene, double part) {
    std::vector<std::pair<double, double>> all; // deviation, mass
    double mass = 0, sum = 0;
    for (const gpu::Particle& p : scene.sample) {
        const double s = 0.1 * double(p.scale) * double(scene.tick.falloff);
        all.emplace_back(s, double(p.sigma_t) * s * s * s), mass += all.back().second;
    }
    std::ranges::sort(all);
    for (const auto& [s, m] : all)
        if ((sum += m) >= part * mass) return s;
    return all.empty() ? 0 : all.back().first;
}

class Member {
public:
    Member(const gpu::Device& device, const CostModel& model, const PromiseQuestion& question, uint64_t seed)
        : device_(device), model_(model), question_(question), random_(randomScene(seed, question.kind)) {
        wanted_.scene = save(random_, question.folder);
        wanted_.size = random_.size;
        wanted_.set = {std::begin(kMediumAlone), std::end(kMediumAlone)};
        wanted_.set.push_back("render.method=" + question.method);
        wanted_.set.push_back(fmt::format("render.error={}", float(question.budget)));
        wanted_.set.push_back(fmt::format("render.flip={}", float(question.flip)));
    }

    json row() {
        row_ = {{"seed", random_.seed},        {"half", random_.seed > kTrained ? "judge" : "train"},
                {"budget", question_.budget},  {"layout", random_.layout},
                {"camera", random_.camera},    {"count", random_.points.position.size()},
                {"spread", random_.spread},    {"depth", random_.depth},
                {"width", random_.size.x},     {"height", random_.size.y},
                {"kind", nameOf(random_.kind)}};
        Stage stage(device_, wanted_, 0, model_);
        addScene(stage.scene());
        addPlan(stage);
        const RadianceImage picture = stage.picture(stage.pose(), random_.size);
        pixels_ = sampleOf(picture, question_.pixels, Random(random_.seed, 100));
        if (pixels_.size() < 40) return row_["why_not"] = "the camera sees less than 40 pixels of the medium", row_;
        const size_t seen = pixels_.size();
        exact_ = truthAt(stage, stage.pose(), random_.size, pixels_, question_.seconds, kLeastPixels);
        pixels_.resize(size_t(exact_.width));
        row_["sampled"] = seen, row_["traced"] = pixels_.size();
        chosen_ = sampled(picture);
        const MediumError error = mediumError(chosen_, exact_, {});
        if (!error.medium.comparable() || !std::isfinite(error.medium.relative_rmse))
            return row_["why_not"] = "nothing to compare: no pixel of the medium is bright and off all edges", row_;
        row_["measured"] = error.medium.relative_rmse, row_["bias"] = error.medium.bias;
        row_["pixels"] = error.medium.pixels;
        const double uncertainty = samplingError(chosen_, exact_, {});
        row_["standard_error"] = std::isfinite(uncertainty) ? uncertainty : error.medium.relative_rmse;
        if (error.edges.pixels > 0) row_["at_edges"] = error.edges.relative_rmse;
        double seen_through = 0;
        for (const float t : exact_.transmittance) seen_through += double(t) / double(exact_.width);
        row_["transmittance"] = seen_through;
        row_["ms"] = frameMs(stage);
        if (question_.price) addPrice(stage);
        if (question_.parts) addParts(stage);
        if (question_.whole) addFlip(stage, picture);
        return row_;
    }

private:
    void addScene(const Scene& scene) {
        const glm::vec3 view = glm::normalize(scene.camera.target - scene.camera.position);
        row_["objects"] = scene.planes.size() + scene.boxes.size() + scene.spheres.size();
        row_["fogs"] = scene.fogs.size(), row_["local_lights"] = localLightsOf(scene).size();
        row_["anisotropy"] = scene.medium.anisotropy, row_["asymmetry"] = scene.medium.asymmetry;
        row_["toward_light"] = glm::dot(view, scene.lights.front().to_light); // -1: the light is behind the eye
    }

    void addPlan(const Stage& stage) {
        const Candidate& chosen = stage.plan().chosen;
        const RenderSettings& s = chosen.settings;
        const PlanScene scene = planScene(stage.scene(), stage.simulation());
        const ViewWork view(scene, {stage.pose(), random_.size.x, random_.size.y});
        const PlanScene::Shadow& shadow =
            *std::ranges::find_if(scene.shadows, [&](const auto& one) { return one.wanted == s.shadow_error; });
        row_["method"] = s.method, row_["way"] = wayText(s), row_["rate"] = s.rate, row_["slabs"] = s.slabs;
        row_["grid_spacing"] = s.grid.spacing, row_["shadow_error"] = s.shadow_error;
        row_["texels"] = {shadow.resolution.texels.x, shadow.resolution.texels.y};
        row_["planes"] = shadow.resolution.slices;
        const glm::vec3 map = scene.tick.map.hi - scene.tick.map.lo;
        row_["map"] = {map.x, map.y, map.z};
        row_["predicted"] = chosen.error, row_["promised"] = stage.plan().within;
        row_["predicted_light"] = view.light().lightFactor() * lightError(shadow.resolution.error);
        row_["predicted_rays"] = raysError(view, s.rate);
        row_["predicted_slabs"] = slabsError(view, s.slabs);
        row_["ray_spacing"] = view.raySpacing(s.rate), row_["slab_thickness"] = view.slabThickness(s.slabs);
        row_["inside"] = view.inside(), row_["deviation"] = scene.extent.deviation;
        row_["deviation_5"] = deviationAt(scene, 0.05), row_["deviation_50"] = deviationAt(scene, 0.5);
        row_["near"] = view.near(), row_["far"] = view.far(), row_["pixel"] = view.pixel();
        for (const SeenLight::Size& size : view.light().sizes())
            row_["sizes"].push_back({size.projected, size.deviation, size.part, size.bend, size.oblique, size.cut});
        row_["light_depth"] = view.light().lightDepth(), row_["light_factor"] = view.light().lightFactor();
        const glm::vec3 box = scene.extent.hi - scene.extent.lo;
        row_["volume"] = double(box.x) * double(box.y) * double(box.z);
        row_["predicted_ms"] = chosen.ms();
    }

    RadianceImage sampled(const RadianceImage& picture) const {
        RadianceImage out{int(pixels_.size()), 1, {}, {}};
        for (const glm::uvec2 at : pixels_) {
            const size_t i = size_t(at.y) * random_.size.x + at.x;
            out.radiance.push_back(picture.radiance[i]), out.transmittance.push_back(picture.transmittance[i]);
        }
        out.medium_alone = picture.medium_alone;
        return out;
    }

    // Of a view and of what all share: the least of some frames.
    static double frameMs(Stage& stage) {
        stage.frame(); // fits buffers
        double least = 1e30, spent = 0;
        for (int i = 0; i < 5 && spent < 1e3 * kFramesSeconds; ++i) {
            const FrameCost cost = stage.frame();
            double sum = 0;
            for (const FrameCost::Pass& pass : cost.passes) sum += pass.ms;
            least = std::min(least, sum), spent += cost.wall_ms;
        }
        return least;
    }

    Case with(const RenderSettings& from, const RenderSettings& settings) const {
        Case other = wanted_;
        const std::vector<std::string> set = changes(from, settings);
        other.set.insert(other.set.end(), set.begin(), set.end());
        return other;
    }

    // The cheapest way that would have held, among the plans of other budgets.
    void addPrice(const Stage& stage) {
        const bool held = row_["measured"] <= question_.budget;
        double least = held ? double(row_["ms"]) : 1e30;
        std::set<std::string> tried{row_["way"].get<std::string>() + row_["shadow_error"].dump()};
        PlanInputs inputs{.scene = planScene(stage.scene(), stage.simulation()), .methods = allMethods()};
        inputs.views = {{stage.pose(), random_.size.x, random_.size.y}};
        for (const double part : {0.06, 0.12, 0.25, 0.5, 2.0, 4.0, 8.0}) {
            if (held == (part < 1)) continue; // finer where it fails, coarser where it holds
            inputs.scene.wanted.error = float(part * question_.budget), inputs.scene.wanted.flip = 1;
            RenderSettings s = makePlan(inputs, model_).chosen.settings;
            if (!tried.insert(wayText(s) + json(s.shadow_error).dump()).second) continue;
            s.error = stage.scene().render.error, s.flip = stage.scene().render.flip;
            Stage other(device_, with(stage.scene().render, s), 0, model_);
            const RadianceImage picture = sampled(other.picture(other.pose(), random_.size));
            if (mediumError(picture, exact_, {}).medium.relative_rmse <= question_.budget)
                least = std::min(least, frameMs(other));
            else if (held)
                break; // coarser ones fail, too
        }
        if (least < 1e30) row_["cheapest_ms"] = least;
    }

    // The chosen way with all that errs much finer.
    static RenderSettings finest(RenderSettings chosen) {
        chosen.rate = std::max(chosen.rate / 2, 1u);
        chosen.slabs = std::min(2 * chosen.slabs, 512u);
        chosen.shadow_error = std::max(chosen.shadow_error / 4, 1e-4f);
        chosen.cutoff /= 100;
        chosen.shading = 1;
        if (chosen.method == "grid")
            chosen.grid.spacing = (chosen.grid.spacing == kAuto ? 0.5f : chosen.grid.spacing) / 2;
        return chosen;
    }

    RenderSettings chosenOf(const Stage& stage) const {
        RenderSettings chosen = stage.plan().chosen.settings;
        chosen.error = stage.scene().render.error, chosen.flip = stage.scene().render.flip;
        return chosen;
    }

    // FLIP of the whole picture, against one by finer settings, and the error of that one's sample.
    void addFlip(const Stage& stage, const RadianceImage& picture) {
        Stage other(device_, with(stage.scene().render, finest(chosenOf(stage))), 0, model_);
        const RadianceImage fine = other.picture(other.pose(), random_.size);
        const MediumError error = mediumError(picture, fine, {});
        if (!error.medium.comparable()) return;
        row_["flip"] = error.medium.flip, row_["predicted_flip"] = stage.plan().chosen.flip;
        row_["finest"] = mediumError(sampled(fine), exact_, {}).medium.relative_rmse;
    }

    // What one part finer changes: the difference to the chosen picture, and the error that is left.
    void addParts(const Stage& stage) {
        const RenderSettings chosen = chosenOf(stage), all = finest(chosen);
        const auto add = [&](const char* part, const RenderSettings& finer) {
            Stage other(device_, with(stage.scene().render, finer), 0, model_);
            const RadianceImage picture = sampled(other.picture(other.pose(), random_.size));
            RadianceImage as_reference = picture;
            as_reference.transmittance = exact_.transmittance, as_reference.edges = exact_.edges;
            row_["parts"][part] = {{"change", mediumError(chosen_, as_reference, {}).medium.relative_rmse},
                                   {"left", mediumError(picture, exact_, {}).medium.relative_rmse}};
        };
        RenderSettings rays = chosen, slabs = chosen, light = chosen, cut = chosen, shading = chosen;
        rays.rate = all.rate, slabs.slabs = all.slabs, light.shadow_error = all.shadow_error;
        cut.cutoff = all.cutoff, shading.shading = all.shading;
        if (rays.rate != chosen.rate) add("rays", rays);
        add("slabs", slabs), add("light", light), add("cut", cut), add("shading", shading);
        if (chosen.method == "grid") {
            RenderSettings nodes = chosen;
            nodes.grid.spacing = all.grid.spacing;
            add("nodes", nodes);
        }
        add("all", all);
    }

    const gpu::Device& device_;
    const CostModel& model_;
    const PromiseQuestion& question_;
    const RandomScene random_;
    Case wanted_;
    std::vector<glm::uvec2> pixels_;
    RadianceImage exact_, chosen_; // of these pixels, one row
    json row_;
};

} // namespace

json promiseRow(const gpu::Device& device, const CostModel& model, const PromiseQuestion& question, uint64_t seed) {
    Member member(device, model, question, seed);
    try {
        return member.row();
    } catch (const std::exception& e) { // one scene's failure is a result, and does not end the others
        return {{"seed", seed}, {"kind", nameOf(question.kind)}, {"budget", question.budget}, {"why_not", e.what()}};
    }
}

std::vector<json> readRows(const std::filesystem::path& file, double budget, RandomKind kind) {
    std::vector<json> rows;
    std::ifstream in(file);
    std::string line;
    for (size_t number = 1; std::getline(in, line); ++number) {
        json row = json::parse(line, nullptr, false);
        const auto fail = [&](const std::string& what) {
            throw std::runtime_error(
                fmt::format("{}:{}: {}; name another file with --rows", file.string(), number, what));
        };
        if (!row.is_object() || !row.contains("seed") || !row["seed"].is_number_unsigned())
            fail("no row of brume-bench promise");
        if (!row.contains("budget") || !row["budget"].is_number() || row["budget"] != budget)
            fail(fmt::format("a row of another budget than {}", budget));
        if (row.value("kind", json("sun")) != nameOf(kind))
            fail(fmt::format("a row of another kind of scenes than {}", nameOf(kind)));
        rows.push_back(std::move(row));
    }
    return rows;
}

std::vector<json> measureRows(const gpu::Device& device, const CostModel& model, const PromiseQuestion& question,
                              const std::filesystem::path& file) {
    std::vector<json> known = readRows(file, question.budget, question.kind), rows;
    if (!file.parent_path().empty()) std::filesystem::create_directories(file.parent_path());
    std::ofstream out(file, std::ios::app);
    for (uint64_t seed = question.seed; seed < question.seed + question.scenes; ++seed) {
        const auto same = std::ranges::find_if(known, [&](const json& row) { return row["seed"] == seed; });
        if (same != known.end()) {
            rows.push_back(*same);
            continue;
        }
        rows.push_back(promiseRow(device, model, question, seed));
        const json& row = rows.back();
        out << row.dump() << '\n';
        if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
        if (row.contains("why_not"))
            std::fprintf(stderr, "  %llu: %s\n", static_cast<unsigned long long>(seed),
                         row["why_not"].get<std::string>().c_str());
        else
            std::fprintf(stderr, "  %llu: %s, predicted %.3f %%, measured %.3f %%\n",
                         static_cast<unsigned long long>(seed), row["way"].get<std::string>().c_str(),
                         100 * row["predicted"].get<double>(), 100 * row["measured"].get<double>());
    }
    return rows;
}

} // namespace brume::bench
