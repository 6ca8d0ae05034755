// brume-bench: renders a view, compares pictures, runs sweeps of settings and reports speed against error.
#include <sys/resource.h>

#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iostream>
#include <thread>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "common/metrics.h"
#include "common/metrics_flip.h"
#include "tools/bench/features.h"
#include "tools/bench/native/compare.h"
#include "tools/bench/pictures.h"
#include "tools/bench/predict.h"
#include "tools/bench/report.h"
#include "tools/bench/sweep.h"

namespace brume::bench {
namespace {

using nlohmann::json;

json readJson(const std::filesystem::path& file) {
    std::ifstream in(file);
    json parsed = json::parse(in, nullptr, false);
    if (parsed.is_discarded())
        throw std::runtime_error(file.string() + ": no JSON; give the results that brume-bench sweep wrote");
    return parsed;
}

// First line of what a command prints; empty when it fails.
std::string said(const char* command) {
    std::string text(256, '\0');
    FILE* pipe = ::popen(command, "r");
    if (!pipe) return {};
    text.resize(std::fread(text.data(), 1, text.size(), pipe));
    ::pclose(pipe);
    return text.substr(0, text.find('\n'));
}

std::string cpu() {
    return said("lscpu | sed -n 's/^Model name: *//p'") + ", " + std::to_string(std::thread::hardware_concurrency()) +
           " threads";
}

std::string today() {
    const std::time_t now = std::time(nullptr);
    char date[16];
    std::strftime(date, sizeof date, "%Y-%m-%d", std::gmtime(&now));
    return date;
}

// To standard output where `file` is empty. Throws std::runtime_error, one line.
void writeText(const std::filesystem::path& file, const std::string& text) {
    if (file.empty()) {
        std::cout << text;
        return;
    }
    std::filesystem::create_directories(file.parent_path().empty() ? "." : file.parent_path());
    std::ofstream out(file);
    out << text;
    if (!out.flush()) throw std::runtime_error(file.string() + ": cannot be written");
    std::cout << file.string() << '\n';
}

struct RenderOptions {
    Case wanted;
    std::string method, size = "640x360", out = "picture.exr";
    bool reference = false;
    uint32_t ticks = 0;
};

void render(const gpu::DeviceOptions& device_options, RenderOptions o, const std::filesystem::path& cache) {
    o.wanted.size = sizeOf(o.size);
    if (!o.method.empty()) o.wanted.set.push_back("render.method=" + o.method);
    const gpu::Device device(device_options);
    Stage stage(device, o.wanted, o.ticks);
    const RadianceImage image =
        o.reference ? Truth(cache).of(stage, stage.pose(), o.wanted.size) : stage.picture(stage.pose(), o.wanted.size);
    const std::filesystem::path out = o.out;
    if (out.extension() == ".png") {
        const RenderSettings& settings = stage.scene().render;
        writePng(out, image.width, image.height, displayed(image, {settings.exposure, settings.tone_map == "filmic"}));
    } else {
        writeExr(out, image);
    }
    std::cout << out.string() << '\n';
}

// Exit code: 0, or 1 when `most` is given and the relative RMSE is above it or not a number.
int comparePictures(const std::string& value_file, const std::string& reference_file, const std::string& map,
                    double most, bool all_pixels) {
    const RadianceImage value = readExr(value_file), reference = readExr(reference_file);
    if (value.width != reference.width || value.height != reference.height)
        throw std::runtime_error("the pictures differ in size");
    const std::vector<uint8_t> mask = all_pixels ? std::vector<uint8_t>{} : mediumMask(reference);
    const Errors errors = compare(value, reference, {}, mask);
    std::cout << describe(errors) << '\n';
    if (!map.empty()) writePng(map, value.width, value.height, colourMap(flipMap(value, reference, {})));
    return most > 0 && !(errors.relative_rmse <= most) ? 1 : 0;
}

void sweep(const gpu::DeviceOptions& device_options, const std::vector<std::string>& files, const Effort& effort,
           const std::filesystem::path& out, const std::filesystem::path& cache, const std::string& command) {
    std::vector<Series> all;
    for (const std::string& file : files) {
        const std::vector<Series> some = loadSweep(file);
        all.insert(all.end(), some.begin(), some.end());
    }
    const gpu::Device device(device_options);
    Truth truth(cache);
    const auto begin = std::chrono::steady_clock::now();
    json results = {{"device", device.name()}, {"driver", device.driver()}, {"command", command}};
    results["series"] = runSweep(device, all, truth, effort);
    results["seconds"] = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    results["peak_mib"] = double(usage.ru_maxrss) / 1024;
    results["commit"] =
        said("git rev-parse --short HEAD 2>/dev/null") +
        (said("git status --porcelain -- . ':!docs/results' 2>/dev/null").empty() ? "" : " with changes");
    results["cpu"] = cpu();
    results["date"] = today();
    writeText(out, results.dump(1) + '\n');
}

void calibrateDevice(const gpu::DeviceOptions& options, const std::filesystem::path& folder, double seconds) {
    const gpu::Device device(options);
    const CostModel model = calibrate(device, seconds);
    const std::filesystem::path file = costFile(folder, device.name(), device.driver());
    saveCosts(file, model, device.name(), device.driver());
    for (const CostInfo* cost : allCosts())
        std::printf("%-15s %10.4f ns per unit, built in %10.4f\n", cost->key, model[*cost], cost->built_in);
    std::cout << file.string() << '\n';
}

void plan(const gpu::DeviceOptions& options, const std::filesystem::path& folder, const std::filesystem::path& cache,
          const PlanTable& wanted, const std::filesystem::path& out, const std::string& command) {
    const gpu::Device device(options);
    std::string complaint;
    const CostModel model = loadCosts(costFile(folder, device.name(), device.driver()), complaint);
    if (!complaint.empty()) std::cerr << complaint << '\n';
    Truth truth(cache);
    const std::string about = fmt::format("# The plan: predicted against measured\n\nWritten by `{}` on {}. CPU: {}. "
                                          "Vulkan device: {}, {}. Costs: {}.\n\n",
                                          command, today(), cpu(), device.name(), device.driver(), model.source);
    writeText(out, about + planTable(device, model, truth, wanted));
}

void features(const gpu::DeviceOptions& options, uint32_t frames, const std::filesystem::path& out,
              const std::string& command) {
    const gpu::Device device(options);
    const std::string about =
        fmt::format("# What is saved by compiling out what a scene does not have\n\nWritten by `{}` on {}. "
                    "CPU: {}. Vulkan device: {}, {}.\n\n"
                    "Scenes without objects, lobe and ambient light, 640x360 from outside, with shaders "
                    "specialised for what is there and, besides, for "
                    "things that are not; the pictures are the same. Least of {} frames each, in turns. "
                    "There is one light in every scene, so that "
                    "nothing is specialised for more.\n\n",
                    command, today(), cpu(), device.name(), device.driver(), frames);
    writeText(out, about + featuresTable(device, frames));
}

struct NativeOptions {
    std::string instructions, out;
    uint32_t frames = 30, threads = 2;
};

// Says and does nothing where the CPU lacks the instructions.
void nativeSlabs(const gpu::DeviceOptions& options, const NativeOptions& o, const std::filesystem::path& cache,
                 const std::string& command) {
    const native::Kernel* kernel = NativeSlabs::named(o.instructions);
    if (!kernel) {
        const std::string wanted = o.instructions.empty() ? "AVX-512 or AVX2" : o.instructions;
        std::cout << "skipped: this CPU (" << cpu() << ") does not have " << wanted << '\n';
        return;
    }
    const gpu::Device device(options);
    Truth truth(cache);
    const std::string table = nativeTable(device, truth, *kernel, o.frames, o.threads);
    writeText(o.out, nativeReport(*kernel, {cpu(), device.name() + ", " + device.driver(), today(), command}, table));
}

int run(int argc, char** argv) {
    CLI::App app{"brume-bench: renders a view, compares pictures, sweeps settings, reports speed against error."};
    app.set_version_flag("--version", "brume-bench " BRUME_VERSION);
    app.require_subcommand(1);
    app.option_defaults()->always_capture_default();
    gpu::DeviceOptions device;
    device.statistics = true;
    std::string cache = "build/bench-cache";
    app.add_option("--device", device.name, "part of the Vulkan device's name; default: a GPU before a CPU driver");
    app.add_option("--cache", cache, "folder of the reference pictures");

    RenderOptions picture;
    CLI::App* render_command =
        app.add_subcommand("render", "one view: linear radiance and transmittance as EXR, or what is seen as PNG");
    render_command->add_option("--scene", picture.wanted.scene, "a shipped scene, or a path");
    render_command->add_option("--camera", picture.wanted.camera, "outside, inside, 20m, x,y,z or x,y,z:x,y,z");
    render_command->add_option("--size", picture.size, "pixels");
    render_command->add_option("--method", picture.method, "instead of the scene's");
    render_command->add_option("--set", picture.wanted.set, "key=value instead of the scene's, as in its file")
        ->default_str("");
    render_command->add_option("--ticks", picture.ticks, "of simulation first")->check(CLI::Range(0, 100000));
    render_command->add_option("--out", picture.out, ".exr or .png");
    render_command->add_flag("--reference", picture.reference, "in double precision, the true overlapping medium");

    std::string value, reference, map;
    double most = 0;
    bool all_pixels = false;
    CLI::App* compare_command =
        app.add_subcommand("compare", "all errors of a picture against its reference, both EXR");
    compare_command->add_option("picture", value)->required();
    compare_command->add_option("reference", reference)->required();
    compare_command->add_option("--flip", map, "write the FLIP map to this PNG");
    compare_command->add_option("--most", most, "exit with 1 when the relative RMSE is larger");
    compare_command->add_flag("--all-pixels", all_pixels, "also those without medium");

    std::vector<std::string> files;
    Effort effort;
    std::string results = "build/bench.json";
    CLI::App* sweep_command =
        app.add_subcommand("sweep", "time and error of lists of settings (tools/bench/sweeps/*.toml)");
    sweep_command->add_option("files", files)->required();
    sweep_command->add_option("--out", results, "JSON");
    sweep_command->add_option("--seconds", effort.seconds, "of frames per variant")->check(CLI::Range(0.0, 600.0));
    sweep_command->add_option("--least", effort.least, "frames per variant, at least")->check(CLI::Range(1, 1000));
    sweep_command->add_option("--only", effort.only, "series whose name holds this");

    std::string costs = defaultCostFolder().string();
    double calibrate_seconds = 15;
    CLI::App* calibrate_command = app.add_subcommand(
        "calibrate", "measures what the plan's predictions need to know of this device, for brume-server");
    calibrate_command->add_option("--costs", costs, "folder of the file");
    calibrate_command->add_option("--seconds", calibrate_seconds, "of frames, beside start-up")
        ->check(CLI::Range(0.0, 600.0));

    PlanTable planned;
    std::string plan_out;
    CLI::App* plan_command = app.add_subcommand("plan", "the plan's choices: predicted against measured, as a table");
    plan_command->add_option("scenes", planned.scenes, "shipped scenes, or paths");
    plan_command->add_option("--cameras", planned.cameras, "as render's");
    plan_command->add_option("--set", planned.set, "key=value instead of the scenes', as in their files")
        ->default_str("");
    plan_command->add_option("--costs", costs, "folder of what calibrate wrote");
    plan_command->add_option("--out", plan_out, "Markdown instead of standard output")->default_str("");

    uint32_t feature_frames = 10;
    std::string features_out;
    CLI::App* features_command = app.add_subcommand(
        "features", "what shaders save that are compiled without what a scene does not have: a table");
    features_command->add_option("--frames", feature_frames, "of each")->check(CLI::Range(1, 10000));
    features_command->add_option("--out", features_out, "Markdown instead of standard output")->default_str("");

    NativeOptions native;
    CLI::App* native_command = app.add_subcommand(
        "native", "slabs on Vulkan beside the same maths written for this CPU's vector units: a table");
    native_command
        ->add_option("--instructions", native.instructions, "AVX-512 or AVX2; default: the widest that the CPU has")
        ->check(CLI::IsMember({"AVX-512", "AVX2"}))
        ->default_str("");
    native_command->add_option("--frames", native.frames, "of each")->check(CLI::Range(1, 10000));
    native_command->add_option("--threads", native.threads, "of the native program")->check(CLI::Range(1, 256));
    native_command->add_option("--out", native.out, "Markdown instead of standard output")->default_str("");

    std::string pictures_only, pictures_out;
    CLI::App* pictures_command = app.add_subcommand(
        "pictures",
        "a fingerprint of every scene's picture by every method: the same text while no bit of any changes");
    pictures_command->add_option("--only", pictures_only, "scenes whose name holds this")->default_str("");
    pictures_command->add_option("--out", pictures_out, "text instead of standard output")->default_str("");

    std::string json_file, before;
    std::string folder = "docs/results", name = "speed-error";
    CLI::App* report_command =
        app.add_subcommand("report", "Markdown and plots of a sweep's results, or a table against earlier ones");
    report_command->add_option("results", json_file)->required();
    report_command->add_option("before", before, "earlier results, to compare with");
    report_command->add_option("--folder", folder);
    report_command->add_option("--name", name);

    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& e) {
        return app.exit(e);
    } catch (const CLI::ParseError& e) {
        std::cerr << "brume-bench: " << e.what() << " (see brume-bench --help)\n";
        return 2;
    }
    std::string command = "brume-bench";
    for (int i = 1; i < argc; ++i) command += std::string(" ") + argv[i];
    if (*render_command) render(device, picture, cache);
    if (*compare_command) return comparePictures(value, reference, map, most, all_pixels);
    if (*sweep_command) sweep(device, files, effort, results, cache, command);
    if (*calibrate_command) calibrateDevice(device, costs, calibrate_seconds);
    if (*plan_command) plan(device, costs, cache, planned, plan_out, command);
    if (*features_command) features(device, feature_frames, features_out, command);
    if (*native_command) nativeSlabs(device, native, cache, command);
    if (*pictures_command) writeText(pictures_out, pictureHashes(gpu::Device(device), pictures_only));
    if (*report_command) {
        if (before.empty())
            writeReport(readJson(json_file), folder, name);
        else
            std::cout << compareResults(readJson(before), readJson(json_file));
    }
    return 0;
}

} // namespace
} // namespace brume::bench

int main(int argc, char** argv) {
    try {
        return brume::bench::run(argc, argv);
    } catch (const std::exception& e) {
        std::cerr << "brume-bench: " << e.what() << std::endl;
        return 1;
    }
}
