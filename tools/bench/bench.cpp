// brume-bench: renders a view, compares pictures, finds the method for a scene, runs sweeps and reports them.
#include <iostream>

#include <CLI/CLI.hpp>

#include "common/option_range.h"
#include "common/view_names.h"
#include "tools/bench/commands.h"

namespace brume::bench {
namespace {

constexpr const char *kQuestions = "Commands", *kMeasurements = "Measurements, as in docs/results",
                     *kDevelopment = "For the code's own sake";

const char* const kSceneHelp = "a shipped scene, or a path";
const char* const kCameraHelp = "outside, inside, 20m, x,y,z or x,y,z:x,y,z (eye:target)";
const char* const kSetHelp = "key=value instead of the scene's, as in its file";
const char* const kOutHelp = "Markdown instead of standard output";

// A command's line in --help, its options, and what it does with them once they are read.
struct Command {
    CLI::App* app;
    std::function<int()> act;
};

class CommandLine {
public:
    explicit CommandLine(CLI::App& app) : app_(app) {
        app_.set_version_flag("--version", "brume-bench " BRUME_VERSION);
        app_.require_subcommand(1);
        app_.option_defaults()->always_capture_default();
        context_.device.statistics = true;
        context_.costs = userCacheFolder();
        context_.cache = context_.costs / "references";
        app_.add_option("--device", context_.device.name,
                        "part of the Vulkan device's name; default: a GPU before a CPU driver");
        app_.add_option("--cache", context_.cache, "folder of the reference pictures");
        addWhich();
        addRender();
        addCompare();
        addCalibrate();
        addSweep();
        addSheet();
        addTetrahedra();
        addReport();
        addTables();
        addPromise();
        addScattering();
        addCorrection();
        addPictures();
    }

    int act(int argc, char** argv) {
        context_.command = "brume-bench";
        for (int i = 1; i < argc; ++i) context_.command += std::string(" ") + argv[i];
        for (const Command& command : commands_)
            if (*command.app) return command.act();
        return 0;
    }

private:
    CLI::App* add(const char* name, const char* group, const char* about, std::function<int()> act) {
        CLI::App* command = app_.add_subcommand(name, about)->group(group);
        commands_.push_back({command, std::move(act)});
        return command;
    }
    template <typename Act>
    CLI::App* addPlain(const char* name, const char* group, const char* about, Act act) {
        return add(name, group, about, [act = std::move(act)] {
            act();
            return 0;
        });
    }
    static void addSet(CLI::App* command, std::vector<std::string>& set) {
        command->add_option("--set", set, kSetHelp)->default_str("");
    }
    void addCosts(CLI::App* command) {
        command->add_option("--costs", context_.costs, "folder of what calibrate wrote");
    }

    void addWhich() {
        WhichOptions& o = which_;
        CLI::App* command = add("which", kQuestions,
                                "which method renders this scene within an error for the least time: predicts all, "
                                "measures the promising ones, prints the lines for the scene's file",
                                [this] { return answerWhich(context_, which_); });
        command->add_option("scenes", o.scenes, kSceneHelp)->required();
        allow(command->add_option("--error", o.question.error, "relative RMSE of the medium's pixels, 0.01 for 1 %"),
              1e-5, 1.0);
        command->add_option("--camera", o.question.wanted.camera, kCameraHelp);
        command->add_option("--size", o.size, "pixels");
        addSet(command, o.question.wanted.set);
        allow(command->add_option("--ticks", o.question.ticks, "of simulation first"), 0, 100000);
        allow(command->add_option("--seconds", o.question.seconds,
                                  "begins no measurement later than this, for each scene"),
              1.0, 3600.0);
        command->add_option("--out", o.out, kOutHelp)->default_str("");
        addCosts(command);
    }

    void addRender() {
        RenderOptions& o = render_;
        CLI::App* command = addPlain("render", kQuestions,
                                     "one view: linear radiance and transmittance as EXR, or what is seen as PNG or "
                                     "JPEG",
                                     [this] { render(context_, render_); });
        command->add_option("--scene", o.wanted.scene, kSceneHelp);
        command->add_option("--camera", o.wanted.camera, kCameraHelp);
        command->add_option("--size", o.size, "pixels");
        command->add_option("--method", o.method, "instead of the scene's");
        addSet(command, o.wanted.set);
        allow(command->add_option("--ticks", o.ticks, "of simulation first"), 0, 100000);
        command->add_option("--out", o.out, ".exr, .png, .jpg or .jpeg");
        command->add_option("--view", o.view, "how the picture is made, in its place: " + allViewNames());
        command->add_flag("--reference", o.reference, "in double precision, the true overlapping medium");
        allow(command->add_option("--paths", o.paths,
                                  "with --reference: light scatters any number of times, so many paths a pixel"),
              2, 1'000'000);
        command->add_flag("--medium-alone", o.medium_alone,
                          "without sky and ambient light: pictures for compare, of which render.error is promised");
    }

    void addCompare() {
        CompareOptions& o = compare_;
        CLI::App* command =
            add("compare", kQuestions, "errors of the medium's pixels, and apart of edges, between two EXR of render",
                [this] { return comparePictures(compare_); });
        command->add_option("picture", o.picture)->required();
        command->add_option("reference", o.reference, "of render --reference, which knows where edges are")->required();
        command->add_option("--flip", o.flip_map, "write the FLIP map to this PNG");
        command->add_option("--most", o.most, "exit with 1 when the relative RMSE is larger");
        command->add_flag("--all-pixels", o.all_pixels, "also those without medium, edges with the others");
    }

    void addCalibrate() {
        CLI::App* command = addPlain("calibrate", kQuestions,
                                     "measures what predictions need to know of this device, for brume-server too",
                                     [this] { calibrateDevice(context_, calibrate_seconds_); });
        addCosts(command);
        allow(command->add_option("--seconds", calibrate_seconds_, "of frames, beside start-up"), 0.0, 600.0);
    }

    void addSweep() {
        SweepOptions& o = sweep_;
        CLI::App* command = addPlain("sweep", kQuestions,
                                     "time and error of lists of settings (docs/sweeps.md, tools/bench/sweeps/*.toml)",
                                     [this] { sweep(context_, sweep_); });
        command->add_option("files", o.files, "TOML, docs/sweeps.md")->required();
        command->add_option("--out", o.out, "JSON");
        allow(command->add_option("--seconds", o.effort.seconds, "of frames per variant"), 0.0, 600.0);
        allow(command->add_option("--least", o.effort.least, "frames per variant, at least"), 1, 1000);
        command->add_option("--only", o.effort.only, "series whose name holds this");
        command->add_flag("--merge", o.merge, "keep what the file has of other series");
    }

    void addSheet() {
        CLI::App* command = addPlain("sheet", kQuestions,
                                     "the pictures of a sweep's series as one: a row for each scene and camera, a "
                                     "column for each variant",
                                     [this] { sheet(context_, sheet_); });
        command->add_option("sweep", sheet_.sweep, "TOML, docs/sweeps.md")->required();
        command->add_option("series", sheet_.series, "its name")->required();
        command->add_option("--size", sheet_.size, "pixels of each picture");
        command->add_option("--out", sheet_.out, ".png, .jpg or .jpeg");
    }

    void addTetrahedra() {
        TetrahedraOptions& o = tetrahedra_;
        CLI::App* command =
            addPlain("tetrahedra", kQuestions, "a PLY file for medium.model = \"tetrahedra\" of a scene's particles",
                     [this] { tetrahedra(tetrahedra_); });
        command->add_option("--scene", o.wanted.scene, kSceneHelp);
        addSet(command, o.wanted.set);
        allow(command->add_option("--ticks", o.ticks, "of simulation first"), 0, 100000);
        allow(command->add_option("--cells", o.cells, "cubes along the longest side, each of twelve tetrahedra"), 1,
              128);
        command->add_option("--out", o.out, ".ply");
    }

    void addReport() {
        ReportOptions& o = report_;
        CLI::App* command = addPlain("report", kMeasurements,
                                     "Markdown and plots of a sweep's results, or a table against earlier ones",
                                     [this] { report(report_); });
        command->add_option("results", o.results, "JSON that sweep wrote")->required();
        command->add_option("before", o.before, "earlier results, to compare with");
        command->add_option("--folder", o.folder, "of the page and its plots");
        command->add_option("--name", o.name, "of the page");
    }

    void addTables() {
        CLI::App* command = addPlain("plan", kMeasurements, "the plan's choices: predicted against measured",
                                     [this] { plan(context_, planned_, plan_out_); });
        command->add_option("scenes", planned_.scenes, kSceneHelp);
        command->add_option("--cameras", planned_.cameras, kCameraHelp);
        addSet(command, planned_.set);
        addCosts(command);
        command->add_option("--out", plan_out_, kOutHelp)->default_str("");

        command = addPlain("features", kMeasurements,
                           "what shaders save that are compiled without what a scene does not have",
                           [this] { features(context_, feature_frames_, features_out_); });
        allow(command->add_option("--frames", feature_frames_, "of each"), 1, 10000);
        command->add_option("--out", features_out_, kOutHelp)->default_str("");

        command = addPlain("mesh-order", kMeasurements, "what drawing tetrahedra in the order of their centres costs",
                           [this] { meshOrder(context_, mesh_order_out_); });
        command->add_option("--out", mesh_order_out_, kOutHelp)->default_str("");

        command = addPlain("scaling", kMeasurements, "what a view costs with 1 to 1,024 lights, and 10 to 4,000 boxes",
                           [this] { scaling(context_, scaling_frames_, scaling_out_); });
        allow(command->add_option("--frames", scaling_frames_, "of each"), 1, 10000);
        command->add_option("--out", scaling_out_, kOutHelp)->default_str("");

        command = addPlain("layers", kMeasurements, "pictures redrawn from layers with depth, beside the true ones",
                           [this] { layers(context_, layers_); });
        command->add_option("--scenes", layers_.question.scenes, "each a scene, or scene:camera")->expected(1, -1);
        command->add_option("--size", layers_.size, "pixels that are shown");
        allow(command->add_option("--quality", layers_.question.quality, "of JPEG; 100: none, as drawn"), 1, 100);
        command->add_flag("--over-time", layers_.question.over_time, "also of a camera that goes on");
        command->add_option("--pictures", layers_.question.pictures, "folder for pictures");
        addCosts(command);
        command->add_option("--out", layers_.out, kOutHelp)->default_str("");

        command = addPlain("drawing", kMeasurements, "what viewers see who draw by themselves, beside the reference",
                           [this] { drawing(context_, drawing_); });
        command->add_option("--scenes", drawing_.question.scenes, "each a scene, or scene:camera")->expected(1, -1);
        command->add_option("--size", drawing_.size, "pixels of a view");
        allow(command->add_option("--pixels", drawing_.question.pixels, "that are traced, of each view"), 1, 100000);
        allow(command->add_option("--ticks", drawing_.question.ticks, "simulated first"), 0, 100000);
        command->add_flag("--links", drawing_.question.links, "also over narrow links, of the first scene");
        addCosts(command);
        command->add_option("--out", drawing_.out, kOutHelp)->default_str("");

        command = addPlain("operations", kMeasurements, "what each operation of a shader costs on the device",
                           [this] { operations(context_, operation_repeats_, operations_out_); });
        allow(command->add_option("--repeats", operation_repeats_, "of each"), 1, 1000);
        command->add_option("--out", operations_out_, kOutHelp)->default_str("");

        command = addPlain("printed-path", kMeasurements,
                           "time of sorted hits and of merged intervals, and paths within icosahedra (seed 003)",
                           [this] { printedPath(context_, path_repeats_, path_out_); });
        allow(command->add_option("--repeats", path_repeats_, "of each"), 1, 1000);
        command->add_option("--out", path_out_, kOutHelp)->default_str("");

        command = addPlain("native", kMeasurements, "slabs on Vulkan beside the same maths on this CPU's vector units",
                           [this] { nativeSlabs(context_, native_); });
        command
            ->add_option("--instructions", native_.instructions,
                         "AVX-512 or AVX2; default: the widest that the CPU has")
            ->check(CLI::IsMember({"AVX-512", "AVX2"}))
            ->default_str("");
        command->add_option("--only", native_.question.only, "scenes whose name holds this")->default_str("");
        allow(command->add_option("--frames", native_.question.frames, "of each"), 1, 10000);
        allow(command->add_option("--threads", native_.question.threads, "of the native program"), 1, 256);
        command->add_option("--out", native_.out, kOutHelp)->default_str("");
    }

    void addPromise() {
        PromiseQuestion& q = promise_.question;
        CLI::App* command = addPlain("promise", kMeasurements,
                                     "whether auto keeps its promised error on random scenes, against the reference",
                                     [this] { keepPromise(context_, promise_); });
        allow(command->add_option("--scenes", q.scenes, "how many"), 1, 1'000'000);
        command->add_option("--seed", q.seed, "of the first; the next has the next seed");
        command->add_option("--kind", promise_.kind, "sun: particles and objects; lit: fogs, points and spots besides")
            ->check(CLI::IsMember({"sun", "lit"}));
        command->add_option("--method", q.method, "instead of auto: how its error is predicted");
        allow(command->add_option("--budget", q.budget, "render.error: relative RMSE"), 1e-5, 1.0);
        allow(command->add_option("--pixels", q.pixels, "compared of each"), 40, 1'000'000);
        allow(command->add_option("--seconds", q.seconds, "of the reference of each"), 0.0, 3600.0);
        command->add_flag("--price", q.price, "also looks for the cheapest way that holds");
        command->add_flag("--parts", q.parts, "also measures what each part of the chosen way errs, into the rows");
        command->add_flag("--whole", q.whole, "also measures FLIP, against the whole picture by finer settings");
        command->add_option("--rows", promise_.rows, "JSON lines, one a scene; a run goes on where they end");
        command->add_option("--out", promise_.out, kOutHelp)->default_str("");
        addCosts(command);
    }

    void addScattering() {
        ScatteringQuestion& q = scattering_.question;
        CLI::App* command =
            addPlain("scattering", kMeasurements,
                     "how light that scatters more than once errs on random scenes, beside random paths",
                     [this] { scattering(context_, scattering_); });
        allow(command->add_option("--scenes", q.scenes, "how many"), 1, 1'000'000);
        command->add_option("--seed", q.seed, "of the first; the next has the next seed");
        allow(command->add_option("--width", q.width, "pixels; the height is 9/16 of it"), 16, 1920);
        allow(command->add_option("--noise", q.noise, "of the paths, that is aimed at"), 1e-4, 1.0);
        allow(command->add_option("--paths", q.paths, "of a pixel, at most"), 16, 1'000'000);
        allow(command->add_option("--seconds", q.seconds, "of the paths of each, at most"), 0.0, 3600.0);
        command->add_option("--out", scattering_.out, kOutHelp)->default_str("");
        addCosts(command);
    }

    void addCorrection() {
        CorrectionQuestion& q = correction_.question;
        CLI::App* command = addPlain("correction", kMeasurements,
                                     "what measuring makes of laws that turn wrong while the server's loop draws",
                                     [this] { correction(context_, correction_); });
        command->add_option("--scene", q.wanted.scene, kSceneHelp);
        command->add_option("--camera", q.wanted.camera, kCameraHelp);
        command->add_option("--size", correction_.size, "pixels");
        addSet(command, q.wanted.set);
        allow(command->add_option("--law-factor", q.law_factor, "on the error of every law"), 0.01, 100.0);
        allow(command->add_option("--at", q.at, "s after the first measured error: the laws turn wrong"), 0.0, 3600.0);
        allow(command->add_option("--seconds", q.seconds, "after the first measured error: the end"), 0.1, 3600.0);
        allow(command->add_option("--measure-error", q.measure_error, "part of one core that measures"), 0.001, 1.0);
        command->add_option("--out", correction_.out, kOutHelp)->default_str("");
        addCosts(command);
    }

    void addPictures() {
        CLI::App* command = addPlain("pictures", kDevelopment,
                                     "a fingerprint of every scene's picture by every method: the same text while no "
                                     "bit of any changes",
                                     [this] { pictures(context_, pictures_only_, pictures_out_); });
        command->add_option("--only", pictures_only_, "scenes whose name holds this")->default_str("");
        command->add_option("--out", pictures_out_, "text instead of standard output")->default_str("");
    }

    CLI::App& app_;
    Context context_;
    std::vector<Command> commands_;
    WhichOptions which_;
    RenderOptions render_;
    CompareOptions compare_;
    double calibrate_seconds_ = 15;
    SweepOptions sweep_;
    SheetOptions sheet_;
    TetrahedraOptions tetrahedra_;
    PromiseOptions promise_;
    ScatteringOptions scattering_;
    CorrectionOptions correction_;
    ReportOptions report_;
    PlanTable planned_;
    LayersOptions layers_{
        .question = {.scenes = {"plume", "cloud", "cumulus", "cloud:inside", "props", "courtyard", "smoke-spots"}}};
    DrawingOptions drawing_{.question = {.scenes = {"cloud", "cloud:inside", "cloud-5000", "cloud-5000:inside", "plume",
                                                    "cumulus", "tubes", "props"}}};
    std::string plan_out_, features_out_, scaling_out_, mesh_order_out_, operations_out_, pictures_only_, pictures_out_,
        path_out_;
    uint32_t feature_frames_ = 10, scaling_frames_ = 5, operation_repeats_ = 12, path_repeats_ = 10;
    NativeOptions native_;
};

int run(int argc, char** argv) {
    CLI::App app{"brume-bench: which method for a scene, pictures and their errors, sweeps of settings.\n"
                 "Begin with: brume-bench which cloud --error 0.01"};
    CommandLine line(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::Success& e) {
        return app.exit(e);
    } catch (const CLI::ParseError& e) {
        std::cerr << "brume-bench: " << e.what() << " (see brume-bench --help)\n";
        return 2;
    }
    return line.act(argc, argv);
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
