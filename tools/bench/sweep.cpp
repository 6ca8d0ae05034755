#include "tools/bench/sweep.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>

#include <nlohmann/json.hpp>

#include "common/scene_reader.h"
#include "common/toml_text.h"
#include "tools/bench/error.h"
#include "tools/bench/ground_error.h"
#include "tools/bench/jpeg_error.h"
#include "tools/bench/light_error.h"
#include "tools/bench/parts.h"
#include "tools/bench/passes.h"
#include "tools/bench/phase_error.h"
#include "tools/bench/seams.h"

namespace brume::bench {
namespace {

using nlohmann::json;

void readVariant(TableReader& in, Variant& out) {
    float published = 0;
    in.text("name", out.name, 64);
    in.texts("set", out.set);
    in.text("size", out.size, 16);
    in.integer("lights", out.lights, limits::kLocalLights);
    in.boolean("mesh_shaders", out.mesh_shaders);
    in.number("published_ms", published, {0, 1e6});
    out.published_ms = double(published);
}

// The variant whose pictures the others are compared with; nothing: they are compared with the reference.
std::optional<size_t> besideIn(const Series& series) {
    for (size_t i = 0; i < series.variants.size(); ++i)
        if (!series.beside.empty() && series.variants[i].name == series.beside) return i;
    return std::nullopt;
}

void readStand(TableReader& in, Stand& out) {
    static constexpr std::string_view kStands[]{"around", "inside"};
    if (const auto stand = in.choice("stand", kStands)) out.inside = kStands[*stand] == "inside";
    in.number("apart", out.apart, {0, 360});
    in.number("eyes_apart", out.eyes_apart, limits::kEyeSeparation, "m");
    if (int(out.inside) + int(out.apart > 0) + int(out.eyes_apart > 0) > 1)
        in.fail(out.inside ? "stand" : "apart", "viewers stand in more than one way",
                "one of stand = \"inside\", apart and eyes_apart");
}

void readSeries(TableReader& in, Series& out) {
    in.text("name", out.name, 64);
    in.text("about", out.about, 400);
    static constexpr std::string_view kKinds[]{"cost", "jpeg", "light", "phase", "seams", "motion", "parts"};
    if (const auto kind = in.choice("kind", kKinds)) out.kind = kKinds[*kind];
    in.texts("scenes", out.scenes);
    in.texts("cameras", out.cameras);
    in.texts("sizes", out.sizes);
    in.texts("viewers", out.viewers);
    readStand(in, out.stand);
    in.integer("ticks", out.ticks, {0, 100000});
    in.boolean("moving", out.moving);
    in.texts("set", out.set);
    in.text("error", out.error, 16);
    in.integer("every", out.every, {1, 99});
    in.boolean("ground", out.ground);
    in.text("baseline", out.baseline, 64);
    in.text("published_on", out.published_on, 100);
    in.texts("qualities", out.qualities);
    in.texts("movers", out.motion.movers);
    for (const std::string& mover : out.motion.movers)
        if (std::ranges::find(kMovers, mover) == std::end(kMovers))
            in.fail("movers", '"' + mover + "\" is not allowed", "camera, particles, sun, lamp, all");
    in.integer("frames", out.motion.frames, {3, 1000});
    in.integer("lead", out.motion.lead, {0, 1000});
    in.number("degrees", out.motion.degrees, {-360, 360});
    in.number("light_degrees", out.motion.light_degrees, {-360, 360});
    in.texts("places", out.motion.places);
    in.tables("variant", out.variants, {1, 100}, readVariant);
    if (out.variants.empty()) out.variants.push_back({.name = "default", .set = {}, .size = {}});
    in.text("beside", out.beside, 64);
    if (!out.beside.empty() && !besideIn(out))
        in.fail("beside", '"' + out.beside + "\" is no variant", "a name of one");
}

Case measuredCase(const Series& series, const Variant& variant, const std::string& scene, const std::string& camera) {
    return caseOf(series, variant, scene, camera, !series.error.empty() || !series.beside.empty());
}

// What the frames of one stage took.
struct Costs {
    std::vector<FrameCost> frames;
    double seconds = 0;

    void add(FrameCost frame) {
        seconds += frame.wall_ms * 1e-3;
        frames.push_back(std::move(frame));
    }

    // Of each frame: ms of the medium's passes of all views, of all passes of the views, and with what is made once for
    // all of them.
    std::vector<double> times(bool (*counts)(const FrameCost::Pass&)) const {
        std::vector<double> out;
        for (const FrameCost& frame : frames) {
            out.push_back(0);
            for (const FrameCost::Pass& pass : frame.passes)
                if (counts(pass)) out.back() += pass.ms;
        }
        return out;
    }

    json summary() const {
        json passes = json::array();
        std::vector<double> shared(frames.size()), each(frames.size()), medium(frames.size()), wall;
        const std::vector<FrameCost::Pass>& first = frames.front().passes;
        for (size_t p = 0; p < first.size(); ++p) {
            std::vector<double> ms;
            for (size_t f = 0; f < frames.size(); ++f) {
                const double took = frames[f].passes.at(p).ms;
                ms.push_back(took);
                (first[p].shared ? shared : each)[f] += took;
                if (!first[p].shared && ofMedium(first[p].name)) medium[f] += took;
            }
            passes.push_back({{"name", first[p].name},
                              {"shared", first[p].shared},
                              {"median", median(ms)},
                              {"least", percentile(ms, 0)},
                              {"p95", percentile(ms, 0.95)}});
        }
        for (const FrameCost& frame : frames) wall.push_back(frame.wall_ms);
        return {{"passes", passes},
                {"frames", frames.size()},
                {"medium_ms", median(medium)},
                {"medium_least_ms", percentile(medium, 0)},
                {"shared_ms", median(shared)},
                {"views_ms", median(each)},
                {"views_least_ms", percentile(each, 0)},
                {"wall_ms", median(wall)},
                {"wall_p95_ms", percentile(wall, 0.95)},
                {"fragments", frames.front().fragments}};
    }
};

// How many times another row's a row's times are, frame by frame: a turn's two frames are neighbours in time. The
// median, and an interval that holds the true one with at least 90 % if frames are alike (5 frames and more; with
// fewer, the least and the most).
json ratioOf(const std::vector<double>& times, const std::vector<double>& others) {
    std::vector<double> ratios;
    for (size_t i = 0; i < std::min(times.size(), others.size()); ++i)
        if (others[i] > 0) ratios.push_back(times[i] / others[i]);
    if (ratios.empty()) return nullptr;
    std::sort(ratios.begin(), ratios.end());
    const auto [low, high] = intervalOfMedian(ratios.size());
    return {{"median", median(ratios)}, {"low", ratios[low]}, {"high", ratios[high]}};
}

bool isOfMedium(const FrameCost::Pass& pass) { return !pass.shared && ofMedium(pass.name); }
bool isOfViews(const FrameCost::Pass& pass) { return !pass.shared; }
bool isAny(const FrameCost::Pass&) { return true; }

Motion motionOf(const Series& series) {
    Motion motion = series.motion;
    motion.errors = !series.error.empty();
    motion.size = sizeOf(motion.errors ? series.error : series.sizes.front());
    motion.every = series.every, motion.ticks = series.ticks, motion.beside = besideIn(series);
    return motion;
}

// A picture beside another of the same size, without sky and ambient light: all pixels that show the medium.
json besideOf(const RadianceImage& picture, const RadianceImage& other, const DisplaySettings& display) {
    json out = toJson(mediumError(picture, other, display));
    out["above_ten"] = partAbove(picture, other, display, 10);
    return out;
}

// All variants of one place, their frames in turns: what disturbs the machine disturbs all alike.
json costRows(const gpu::Device& device, const Series& series, const std::string& scene, const std::string& camera,
              const std::string& size, const std::string& viewers, Truth& truth, const Effort& effort) {
    std::vector<std::unique_ptr<Stage>> stages;
    std::vector<Costs> costs(series.variants.size());
    for (const Variant& variant : series.variants) {
        Case wanted = measuredCase(series, variant, scene, camera);
        wanted.size = sizeOf(variant.size.empty() ? size : variant.size);
        wanted.viewers = uint32_t(std::stoul(viewers));
        if (!variant.mesh_shaders && !effort.without_mesh)
            throw std::runtime_error(series.name + ": no device without mesh shaders was given");
        const gpu::Device& drawn_by = variant.mesh_shaders ? device : *effort.without_mesh;
        stages.push_back(std::make_unique<Stage>(drawn_by, wanted, series.ticks));
        stages.back()->frame(); // compiles shaders, fits buffers
    }
    for (bool all_done = false; !all_done;) {
        all_done = true;
        for (size_t i = 0; i < stages.size(); ++i) {
            if (costs[i].frames.size() >= effort.least && costs[i].seconds >= effort.seconds) continue;
            costs[i].add(series.moving ? stages[i]->nextFrame() : stages[i]->frame());
            all_done = false;
        }
    }
    const std::optional<size_t> beside = besideIn(series);
    std::vector<RadianceImage> pictures;
    if (beside)
        for (const std::unique_ptr<Stage>& stage : stages)
            pictures.push_back(stage->picture(stage->pose(), sizeOf(size)));
    json rows = json::array();
    const auto named = [&](const Variant& v) { return v.name == series.baseline; };
    const auto chosen = std::ranges::find_if(series.variants, named);
    const Costs& base = costs[chosen == series.variants.end() ? 0 : size_t(chosen - series.variants.begin())];
    for (size_t i = 0; i < stages.size(); ++i) {
        Stage& stage = *stages[i];
        json row = costs[i].summary();
        row["over_baseline"] = {{"medium", ratioOf(costs[i].times(isOfMedium), base.times(isOfMedium))},
                                {"views", ratioOf(costs[i].times(isOfViews), base.times(isOfViews))},
                                {"frame", ratioOf(costs[i].times(isAny), base.times(isAny))}};
        row.update({{"scene", scene},
                    {"camera", series.stand.inside ? "all inside" : camera},
                    {"size", size},
                    {"viewers", std::stoul(viewers)},
                    {"variant", series.variants[i].name},
                    {"set", series.variants[i].set},
                    {"particles", stage.simulation().liveCount()},
                    {"device_mib", double(stage.deviceBytes()) / (1 << 20)},
                    {"particles_mib", double(stage.particleBytes()) / (1 << 20)}});
        const LightWork& light = costs[i].frames.back().light;
        if (light.any())
            row["light"] = {{"voxel_rays", light.voxel_rays}, {"froxel_rays", light.froxel_rays},
                            {"places", light.places},         {"samples", light.samples},
                            {"nodes", light.nodes},           {"holes", light.holes}};
        if (light.voxel_rays > 0 && series.stand.apart > 0) row["light"]["voxel_rays_alone"] = stage.voxelRaysAlone();
        if (series.variants[i].published_ms > 0) row["published_ms"] = series.variants[i].published_ms;
        std::string said; // of the error
        if (!series.error.empty()) {
            const glm::uvec2 small = sizeOf(series.error);
            const RadianceImage exact = truth.of(stage, stage.pose(), small, series.every);
            const MediumError error = mediumError(thinned(stage.picture(stage.pose(), small), series.every), exact,
                                                  displayOf(stage.scene().render));
            row["error"] = toJson(error);
            said = inShort(error);
        }
        if (beside) {
            row["beside"] = besideOf(pictures[i], pictures[*beside], displayOf(stage.scene().render));
            said +=
                fmt::format("  beside {}: {:.3g} %", series.beside, 100 * row["beside"]["relative_rmse"].get<double>());
        }
        if (series.ground) {
            const GroundError ground = groundError(device, measuredCase(series, series.variants[i], scene, camera),
                                                   sizeOf(series.error.empty() ? size : series.error), series.ticks);
            row["ground"] = {{"rms", ground.rms}, {"bias", ground.bias}, {"places", ground.places}};
            said += "; ground " + std::to_string(ground.rms);
        }
        std::fprintf(stderr, "  %-12s %-8s %-10s x%s  %-28s %8.1f ms  %s\n", scene.c_str(), camera.c_str(),
                     size.c_str(), viewers.c_str(), series.variants[i].name.c_str(), row["medium_ms"].get<double>(),
                     said.c_str());
        rows.push_back(std::move(row));
    }
    return rows;
}

} // namespace

Case caseOf(const Series& series, const Variant& variant, const std::string& scene, const std::string& camera,
            bool medium_alone) {
    Case wanted;
    wanted.scene = scene;
    wanted.camera = camera;
    wanted.lights = variant.lights;
    wanted.stand = series.stand;
    wanted.set = series.set;
    if (medium_alone) wanted.set.insert(wanted.set.end(), std::begin(kMediumAlone), std::end(kMediumAlone));
    wanted.set.insert(wanted.set.end(), variant.set.begin(), variant.set.end());
    return wanted;
}

std::vector<Series> loadSweep(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::stringstream text;
    text << in.rdbuf();
    if (!in) throw SceneError(file.string() + ": cannot be read; give the path of a sweep's TOML file");
    toml::table root;
    try {
        root = parseToml(text.str(), file.string());
    } catch (const toml::parse_error& error) {
        throw SceneError(file.string() + ':' + std::to_string(error.source().begin.line) +
                         ": syntax: " + std::string(error.description()));
    }
    const std::string name = file.string();
    std::vector<Series> all;
    TableReader reader(root, "", name);
    reader.tables("series", all, {1, 100}, readSeries);
    reader.finish();
    return all;
}

json runSweep(const gpu::Device& device, const std::vector<Series>& all, Truth& truth, const Effort& effort) {
    json result = json::array();
    for (const Series& series : all) {
        if (series.name.find(effort.only) == std::string::npos) continue;
        std::fprintf(stderr, "%s\n", series.name.c_str());
        json rows = json::array();
        const auto take = [&](const json& some) { rows.insert(rows.end(), some.begin(), some.end()); };
        for (const std::string& scene : series.scenes)
            for (const std::string& camera : series.cameras) {
                std::vector<NamedCase> cases;
                for (const Variant& variant : series.variants)
                    cases.push_back({variant.name, measuredCase(series, variant, scene, camera)});
                const glm::uvec2 size = series.error.empty() ? glm::uvec2() : sizeOf(series.error);
                if (series.kind == "seams") take(seamRows(device, cases, size, series.ticks));
                if (series.kind == "phase") take(phaseRows(device, cases, size));
                if (series.kind == "parts") take(partsRows(device, cases, size, series.every, series.ticks));
                if (series.kind == "light") take(lightRows(device, cases, size, effort));
                if (series.kind == "motion") take(motionRows(device, cases, motionOf(series), truth));
                if (series.kind == "jpeg")
                    for (const NamedCase& one : cases)
                        for (const std::string& shown : series.sizes)
                            take(jpegRows(device, one.name, one.wanted, sizeOf(shown), series.qualities));
                if (series.kind == "cost")
                    for (const std::string& shown : series.sizes)
                        for (const std::string& viewers : series.viewers)
                            take(costRows(device, series, scene, camera, shown, viewers, truth, effort));
            }
        result.push_back({{"name", series.name},
                          {"about", series.about},
                          {"kind", series.kind},
                          {"error", series.error},
                          {"every", series.every},
                          {"beside", series.beside},
                          {"baseline", series.baseline.empty() ? series.variants.front().name : series.baseline},
                          {"published_on", series.published_on},
                          {"set", series.set},
                          {"rows", rows}});
    }
    return result;
}

} // namespace brume::bench
