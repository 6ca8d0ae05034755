#include "tools/bench/commands.h"

#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "common/metrics.h"
#include "common/metrics_flip.h"
#include "common/view_names.h"
#include "tools/bench/error.h"
#include "tools/bench/features.h"
#include "tools/bench/lattice.h"
#include "tools/bench/mesh_order.h"
#include "tools/bench/operations/operations.h"
#include "tools/bench/page.h"
#include "tools/bench/picture_file.h"
#include "tools/bench/pictures.h"
#include "tools/bench/printed_path.h"
#include "tools/bench/promise_page.h"
#include "tools/bench/report.h"
#include "tools/bench/results_file.h"
#include "tools/bench/scaling.h"
#include "tools/bench/sheet.h"

namespace brume::bench {
namespace {

using nlohmann::json;

// Where results are from. `device`: null if none takes part.
json madeBy(const Context& context, const gpu::Device* device) {
    const bool changed = !said("git status --porcelain -- . ':!docs' 2>/dev/null").empty();
    return {{"device", device ? device->name() : "none"},
            {"driver", device ? device->driver() : "none"},
            {"cpu", cpu()},
            {"command", context.command},
            {"commit", said("git rev-parse --short HEAD 2>/dev/null") + (changed ? " with changes" : "")},
            {"date", today()}};
}

// "PNG" or "JPEG" for a file of that name; empty for others.
std::string formatNamed(const std::filesystem::path& file) {
    const std::filesystem::path kind = file.extension();
    return kind == ".png" ? "PNG" : kind == ".jpg" || kind == ".jpeg" ? "JPEG" : "";
}

CostModel costsOf(const Context& context, const gpu::Device& device) {
    std::string complaint;
    CostModel model = loadCosts(costFile(context.costs, device.name(), device.driver()), complaint);
    if (!complaint.empty()) std::cerr << complaint << '\n';
    model.on_cpu = device.isCpu();
    return model;
}

} // namespace

void render(const Context& context, RenderOptions o) {
    if (const std::string refused = pictureRefusal(o.out); !refused.empty())
        throw std::runtime_error("--out " + refused);
    const auto view = viewNamed(o.view);
    if (!view) throw std::runtime_error(fmt::format("no view \"{}\"; there are {}", o.view, allViewNames()));
    if (*view != gpu::kShowPicture && (o.reference || formatNamed(o.out).empty()))
        throw std::runtime_error("--view is what is seen: a .png, .jpg or .jpeg, without --reference");
    if (o.paths > 0 && !o.reference)
        throw std::runtime_error("--paths is of the reference: add --reference; renderers have render.scattering");
    o.wanted.size = sizeOf(o.size);
    if (o.medium_alone) o.wanted.set.insert(o.wanted.set.end(), std::begin(kMediumAlone), std::end(kMediumAlone));
    if (!o.method.empty()) o.wanted.set.push_back("render.method=" + o.method);
    const gpu::Device device(context.device);
    Stage stage(device, o.wanted, o.ticks);
    if (*view != gpu::kShowPicture) {
        writePixels(o.out, o.wanted.size, stage.shown(stage.pose(), o.wanted.size, *view));
        std::cout << o.out << '\n';
        return;
    }
    RadianceImage image;
    if (o.paths > 0) {
        double error = 0;
        image = Truth(context.cache).scattered(stage, stage.pose(), o.wanted.size, int(o.paths), error);
        std::cout << fmt::format("standard error {:.2g} %\n", 100 * error);
    } else {
        image = o.reference ? Truth(context.cache).of(stage, stage.pose(), o.wanted.size)
                            : stage.picture(stage.pose(), o.wanted.size);
    }
    writePicture(o.out, image, displayOf(stage.scene().render));
    std::cout << o.out << '\n';
}

int comparePictures(const CompareOptions& o) {
    for (const std::string& file : {o.picture, o.reference})
        if (const std::string kind = formatNamed(file); !kind.empty())
            throw std::runtime_error(fmt::format("{} is a {}; compare takes the EXR of render", file, kind));
    const RadianceImage value = readExr(o.picture), reference = readExr(o.reference);
    if (!value.edges.empty() && reference.edges.empty())
        throw std::runtime_error(fmt::format("the reference comes second: {} has edges marked (channel E), {} has none",
                                             o.picture, o.reference));
    if (value.width != reference.width || value.height != reference.height)
        throw std::runtime_error(fmt::format("the pictures differ in size: {} is {}x{}, {} is {}x{}", o.picture,
                                             value.width, value.height, o.reference, reference.width,
                                             reference.height));
    Errors errors;
    if (o.all_pixels) {
        errors = compare(value, reference, {});
        std::cout << "all pixels: " << describe(errors) << '\n';
    } else {
        const MediumError error = mediumError(value, reference, {});
        std::cout << describe(error) << '\n';
        errors = error.medium;
    }
    if (!o.flip_map.empty()) writePng(o.flip_map, value.width, value.height, colourMap(flipMap(value, reference, {})));
    return o.most > 0 && !(errors.relative_rmse <= o.most) ? 1 : 0;
}

int answerWhich(const Context& context, const WhichOptions& o) {
    const gpu::Device device(context.device);
    const CostModel model = costsOf(context, device);
    std::string page;
    bool all_hold = true;
    for (const std::string& scene : o.scenes) {
        Question question = o.question;
        question.wanted.scene = scene;
        question.wanted.size = sizeOf(o.size);
        const Answers answers = which(device, model, question);
        all_hold = all_hold && answers.holds;
        page += whichText(question, answers);
    }
    if (o.out.empty())
        std::cout << page;
    else
        writeText(o.out, headed(fmt::format("Which method within {:.3g} %?", 100 * o.question.error), context, device,
                                &model) +
                             whichLegend() + page);
    return all_hold ? 0 : 1;
}

void keepPromise(const Context& context, PromiseOptions o) {
    o.question.folder = context.costs / "random-scenes";
    o.question.kind = o.kind == nameOf(RandomKind::lit) ? RandomKind::lit : RandomKind::sun;
    const bool lit = o.question.kind == RandomKind::lit;
    const gpu::Device device(context.device);
    const CostModel model = costsOf(context, device);
    const std::vector<json> rows = measureRows(device, model, o.question, o.rows);
    std::string page =
        headed(lit ? "Does `auto` keep its promise among fogs and lights?" : "Does `auto` keep its promise?", context,
               device, &model);
    page += fmt::format(
        "Random scenes{}, drawn from the seeds {} to {} by `auto` with `render.error` {:.3g} %. A random sample of the "
        "medium's pixels is compared with the reference. Errors as "
        "[`conventions.md`](../../conventions.md#errors) defines them; ± two standard errors. "
        "Constants of laws were chosen on seeds 1 to 110 (train), none on the others (judge).\n\n"
        "The command writes its scenes to `random-scenes` in the folder of `--costs`. One picture again: `brume-bench "
        "render --scene FOLDER/random-{}SEED.toml --size WxH --medium-alone --set render.error={:.3g}`.\n\n",
        lit ? " with 0 to 2 fogs, 0 to 6 points and spots, and boxes and spheres beside the medium and the sun" : "",
        o.question.seed, o.question.seed + o.question.scenes - 1, 100 * o.question.budget, lit ? "lit-" : "",
        o.question.budget);
    if (!o.out.empty()) {
        const std::filesystem::path plot = std::filesystem::path(o.out).replace_extension(".svg");
        writeText(plot, promisePlot(rows));
        page += fmt::format("![measured over predicted error]({})\n\n", plot.filename().string());
    }
    writeText(o.out, page + promisePage(rows, o.question.budget, o.question.flip));
    std::cerr << "scenes: " << o.question.folder.string() << ", rows: " << o.rows.string() << '\n';
}

void scattering(const Context& context, ScatteringOptions o) {
    o.question.folder = context.costs / "random-scenes", o.question.references = context.cache;
    const gpu::Device device(context.device);
    const CostModel model = costsOf(context, device);
    std::vector<ScatteringRow> rows;
    for (uint32_t i = 0; i < o.question.scenes; ++i) {
        rows.push_back(scatteringRow(device, model, o.question, o.question.seed + i));
        std::cerr << fmt::format("  {} of {}\n", i + 1, o.question.scenes);
    }
    writeText(o.out,
              headed("Light that scatters more than once, in random scenes", context, device) +
                  "Random scenes, drawn by `auto` with each `render.scattering`, beside random paths in "
                  "double precision. RMSE and bias are of the radiance of the medium's pixels without edges, without "
                  "sky and ambient light. The noise of the paths is taken out of the RMSE, and 0 is "
                  "where it hides the error. Nothing was tuned on these seeds.\n\n" +
                  scatteringPage(rows));
}

void correction(const Context& context, CorrectionOptions o) {
    CorrectionQuestion& q = o.question;
    q.wanted.size = sizeOf(o.size);
    if (q.at >= q.seconds) throw std::runtime_error("--seconds: must be more than --at");
    const gpu::Device device(context.device);
    const CostModel model = costsOf(context, device);
    const CorrectionRun run = correctionRun(device, model, q);
    std::string page = headed("The correction at work", context, device, &model);
    page += fmt::format(
        "The server's frame loop draws `{}` with `auto` for one viewer, {}, who flies slowly around it. {:.3g} s after "
        "the first measured error the error of every law is multiplied by {:.3g}, and a command makes the plan anew: "
        "it then takes what is too coarse. Without a command it would first wait two seconds, as for anything that is "
        "only cheaper. The budget, `render.error`, is {:.3g} %. Measuring takes {:.3g} of a core; overload is switched "
        "off. Measured is the error of the newest 100 to 256 pixels, by which the plan learns: it changes once 100 "
        "pixels of new pictures are traced. Predicted is the plan's own, as corrected. "
        "Errors as [`conventions.md`](../../conventions.md#errors) defines them.\n\n",
        q.wanted.scene, o.size, q.at, q.law_factor, 100 * run.promised, q.measure_error);
    if (!o.out.empty()) {
        const std::string name = o.out.stem().string();
        writeText(o.out.parent_path() / (name + ".svg"), correctionPlot(run));
        writeText(o.out.parent_path() / (name + "-settings.svg"), settingsPlot(run));
        page += fmt::format("![measured and predicted error over time]({0}.svg)\n\n"
                            "![chosen settings over time]({0}-settings.svg)\n\n",
                            name);
    }
    writeText(o.out, page + correctionPage(run));
}

void sweep(const Context& context, const SweepOptions& o) {
    std::vector<Series> all;
    for (const std::string& file : o.files) {
        const std::vector<Series> some = loadSweep(file);
        all.insert(all.end(), some.begin(), some.end());
    }
    const gpu::Device device(context.device);
    gpu::DeviceOptions options = context.device;
    options.mesh_shaders = false;
    const gpu::Device without_mesh(options);
    Effort effort = o.effort;
    effort.without_mesh = &without_mesh;
    Truth truth(context.cache);
    const auto begin = std::chrono::steady_clock::now();
    const json made = madeBy(context, &device);
    json results = made;
    results["series"] = runSweep(device, all, truth, effort);
    for (json& series : results["series"]) series["made"] = made;
    results["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    results["peak_mib"] = double(usage.ru_maxrss) / 1024;
    if (o.merge && std::filesystem::exists(o.out)) results = merged(readResults(o.out), results);
    writeText(o.out, textOf(results));
}

void sheet(const Context& context, const SheetOptions& o) {
    if (formatNamed(o.out).empty()) throw std::runtime_error("--out " + o.out + ": allowed: .png, .jpg, .jpeg");
    const std::vector<Series> all = loadSweep(o.sweep);
    const auto found = std::ranges::find(all, o.series, &Series::name);
    if (found == all.end()) {
        std::string names;
        for (const Series& series : all) names += (names.empty() ? "" : "; ") + series.name;
        throw std::runtime_error(fmt::format("{}: no series \"{}\"; there are: {}", o.sweep, o.series, names));
    }
    const gpu::Device device(context.device);
    writeSheet(device, *found, sizeOf(o.size), o.out);
    std::cout << o.out << '\n';
}

void meshOrder(const Context& context, const std::filesystem::path& out) {
    const json made = madeBy(context, nullptr);
    json results = made;
    results["series"] = {{{"name", "Order of centres"}, {"baseline", ""}, {"made", made}, {"rows", meshOrderRows({})}}};
    writeText(out, textOf(results));
}

void tetrahedra(const TetrahedraOptions& o) {
    const Scene scene = sceneOf(o.wanted);
    if (scene.medium.model != kSumMedium)
        throw SceneError(fmt::format("{}: medium.model = \"{}\"; only \"sum\" has particles that add up",
                                     o.wanted.scene, scene.medium.model));
    Simulation simulation(scene);
    for (uint32_t i = 0; i < o.ticks; ++i) simulation.step({});
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    const Lattice lattice = latticeOf(particles, simulation.now().medium.falloff, o.cells);
    writeText(o.out, plyOf(lattice, scene.origin));
    const glm::vec3 albedo = particles[0].albedo;
    std::cerr << fmt::format(
        "{} tetrahedra of {} points, cubes of {:.4g} m, extinction up to {:.4g} 1/m, {}\n", lattice.corners.size(),
        lattice.position.size(), lattice.cell, std::ranges::max(lattice.sigma_t),
        lattice.albedo.empty() ? fmt::format("medium.albedo = [{}, {}, {}]", albedo.x, albedo.y, albedo.z)
                               : "with albedos");
}

void calibrateDevice(const Context& context, double seconds) {
    const gpu::Device device(context.device);
    const CostModel model = calibrate(device, seconds);
    const std::filesystem::path file = costFile(context.costs, device.name(), device.driver());
    saveCosts(file, model, device.name(), device.driver());
    for (const CostInfo* cost : allCosts())
        std::printf("%-15s %10.4f ns per unit, built in %10.4f\n", cost->key, model[*cost], cost->built_in);
    std::cout << file.string() << '\n';
}

void plan(const Context& context, const PlanTable& wanted, const std::filesystem::path& out) {
    const gpu::Device device(context.device);
    const CostModel model = costsOf(context, device);
    Truth truth(context.cache);
    writeText(out, headed("The plan: predicted against measured", context, device, &model) +
                       planTable(device, model, truth, wanted));
}

void features(const Context& context, uint32_t frames, const std::filesystem::path& out) {
    const gpu::Device device(context.device);
    const std::string about =
        headed("What is saved by compiling out what a scene does not have", context, device) +
        fmt::format(
            "Scenes without objects, lobe and ambient light, 640x360 from outside, with shaders specialised for "
            "what is there and, besides, for things that are not; the pictures are the same. Least of {} frames "
            "each, in turns. There is one light in every scene, so that nothing is specialised for more.\n\n",
            frames);
    writeText(out, about + featuresTable(device, frames));
}

void layers(const Context& context, LayersOptions options) {
    const gpu::Device device(context.device);
    options.question.size = sizeOf(options.size);
    const std::string about =
        headed("Pictures redrawn from layers with depth", context, device) +
        fmt::format("A picture and its layers are drawn {} wider than what is shown, coded as viewers get them, and "
                    "redrawn from another place. The true picture there is drawn the same way.\n\n",
                    options.question.margin);
    writeText(options.out, about + layersTables(device, costsOf(context, device), options.question));
}

void drawing(const Context& context, DrawingOptions options) {
    const gpu::Device device(context.device);
    options.question.size = sizeOf(options.size);
    const std::string about =
        headed("What viewers draw by themselves", context, device) +
        fmt::format(
            "Relative RMSE of {} pixels at random, of those that show the medium and no edge, against the "
            "reference, without sky and ambient light. What viewers do is done in double, at single rays: what "
            "their coarse rays err comes on top. Light: the fits, with 64 slabs; slabs: eight of them beside 64; "
            "rounding: of the message's numbers; drawn: all of it. Bytes are those of a particle in a message, "
            "of 30 a second.\n\n",
            options.question.pixels);
    writeText(options.out, about + drawingTable(device, costsOf(context, device), options.question));
}

void scaling(const Context& context, uint32_t frames, const std::filesystem::path& out) {
    const gpu::Device device(context.device);
    const std::string about =
        headed("Cost against the number of lights and objects", context, device) +
        fmt::format("Pictures of 640x360 by `slabs`, a ray per 4x4 pixels, 48 slabs; medians of {} frames, which the "
                    "rows of a table take in turns. Each column is a pass. Passes that take less than 0.005 ms in all "
                    "rows are left out.\n\n",
                    frames);
    const char* const off =
        "## What is not there\n\nOne sun and particles, without fog, lights or objects: shaders are "
        "compiled without the code of what a scene lacks. What that code costs where it is compiled "
        "in and finds nothing, scene `cloud`; least of the frames:\n\n";
    writeText(out,
              about + scalingTables(device, frames, context.costs / "scaling") + off + absentFeatures(device, frames));
}

void nativeSlabs(const Context& context, const NativeOptions& o) {
    const native::Kernel* kernel = NativeSlabs::named(o.instructions);
    if (!kernel) {
        const std::string wanted = o.instructions.empty() ? "AVX-512 or AVX2" : o.instructions;
        std::cout << "skipped: this CPU (" << cpu() << ") does not have " << wanted << '\n';
        return;
    }
    const gpu::Device device(context.device);
    Truth truth(context.cache);
    const std::string table = nativeTable(device, truth, *kernel, o.question);
    writeText(o.out,
              nativeReport(*kernel, {cpu(), device.name() + ", " + device.driver(), today(), context.command}, table));
}

void operations(const Context& context, uint32_t repeats, const std::filesystem::path& out) {
    const gpu::Device device(context.device);
    const char* const threads = std::getenv("LP_NUM_THREADS");
    const std::string about = fmt::format(
        "# What an operation of a shader costs\n\nWritten by `{}` on {}{}. CPU: {}. Vulkan device: {}, {}.\n\n"
        "Nanoseconds of the device for an operation of one lane, the least of {} runs. The loop around it is counted "
        "in, and has the first row. Indices are those of neighbours, the same for all lanes, or scattered.\n\n",
        context.command, today(), threads ? fmt::format(", LP_NUM_THREADS={}", threads) : "", cpu(), device.name(),
        device.driver(), repeats);
    writeText(out, about + operationsTable(device, repeats));
}

void printedPath(const Context& context, uint32_t repeats, const std::filesystem::path& out) {
    const json made = madeBy(context, nullptr);
    json results = made;
    results["series"] = printedPathSeries(repeats);
    for (json& series : results["series"]) series["made"] = made;
    writeText(out, textOf(results));
}

void pictures(const Context& context, const std::string& only, const std::filesystem::path& out) {
    writeText(out, pictureHashes(gpu::Device(context.device), only));
}

void report(const ReportOptions& o) {
    const json results = readResults(o.results);
    if (o.before.empty()) return writeReport(results, o.folder, o.name);
    std::cout << compareResults(readResults(o.before), results);
}

} // namespace brume::bench
