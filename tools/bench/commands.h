// The commands of brume-bench, each a function. All throw std::exception with one line.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/gpu/device.h"
#include "tools/bench/correction.h"
#include "tools/bench/drawing.h"
#include "tools/bench/layers.h"
#include "tools/bench/native/compare.h"
#include "tools/bench/predict.h"
#include "tools/bench/promise.h"
#include "tools/bench/scattering.h"
#include "tools/bench/sweep.h"
#include "tools/bench/which.h"

namespace brume::bench {

// What several commands share.
struct Context {
    gpu::DeviceOptions device;
    std::filesystem::path cache; // folder of reference pictures
    std::filesystem::path costs; // folder of what calibrate wrote
    std::string command;         // the command line, for the heads of pages
};

struct RenderOptions {
    Case wanted;
    std::string method, size = "640x360", out = "picture.exr", view = "picture";
    bool reference = false;    // True: in double precision
    bool medium_alone = false; // True: without sky and ambient light
    uint32_t ticks = 0;        // simulated first
    uint32_t paths = 0;        // random paths of a pixel; 0: single scattering. Only with `reference`
};
void render(const Context& context, RenderOptions options);

struct CompareOptions {
    std::string picture, reference, flip_map;
    double most = 0;         // largest relative RMSE that is well; 0: any
    bool all_pixels = false; // True: also those without medium
};
// Exit code: 0, or 1 if the relative RMSE is above `most` or not a number.
int comparePictures(const CompareOptions& options);

struct WhichOptions {
    std::vector<std::string> scenes;
    std::string size = "640x360", out;
    Question question; // its scene and size are replaced
};
// Exit code: 0, or 1 if nothing holds the error in a scene.
int answerWhich(const Context& context, const WhichOptions& options);

struct PromiseOptions {
    PromiseQuestion question; // its folder and kind are replaced
    std::string kind = "sun";
    std::filesystem::path rows = "build/promise.jsonl", out;
};
void keepPromise(const Context& context, PromiseOptions options);

struct ScatteringOptions {
    ScatteringQuestion question; // its folders are replaced
    std::filesystem::path out;
};
void scattering(const Context& context, ScatteringOptions options);

struct CorrectionOptions {
    CorrectionQuestion question; // its scene's size is replaced
    std::string size = "640x360";
    std::filesystem::path out;
};
void correction(const Context& context, CorrectionOptions options);

struct SweepOptions {
    std::vector<std::string> files;
    std::string out = "build/bench.json";
    bool merge = false; // True: what `out` has of other series stays
    Effort effort;
};
void sweep(const Context& context, const SweepOptions& options);

struct SheetOptions {
    std::string sweep, series; // TOML, and the name of one of its series
    std::string size = "240x135";
    std::string out = "sheet.jpg";
};
void sheet(const Context& context, const SheetOptions& options);

// What sorting tetrahedra by their centres costs; JSON as of a sweep.
void meshOrder(const Context& context, const std::filesystem::path& out);

struct TetrahedraOptions {
    Case wanted;
    uint32_t ticks = 0;  // simulated first
    uint32_t cells = 16; // cubes along the longest side
    std::string out = "tetrahedra.ply";
};
void tetrahedra(const TetrahedraOptions& options);

void calibrateDevice(const Context& context, double seconds);
void plan(const Context& context, const PlanTable& wanted, const std::filesystem::path& out);
void features(const Context& context, uint32_t frames, const std::filesystem::path& out);
struct LayersOptions {
    LayersQuestion question; // its size is replaced
    std::string size = "640x360";
    std::filesystem::path out;
};
void layers(const Context& context, LayersOptions options);
struct DrawingOptions {
    DrawingQuestion question; // its size is replaced
    std::string size = "640x360";
    std::filesystem::path out;
};
void drawing(const Context& context, DrawingOptions options);
void scaling(const Context& context, uint32_t frames, const std::filesystem::path& out);

struct NativeOptions {
    std::string instructions, out;
    NativeQuestion question;
};
// Says so and does nothing if the CPU lacks the instructions.
void nativeSlabs(const Context& context, const NativeOptions& options);

// What each operation of a shader costs on the device, the least of `repeats`.
void operations(const Context& context, uint32_t repeats, const std::filesystem::path& out);
// What sorting and walking hits costs beside merging intervals, and what icosahedra change. Needs no device.
void printedPath(const Context& context, uint32_t repeats, const std::filesystem::path& out);
void pictures(const Context& context, const std::string& only, const std::filesystem::path& out);

struct ReportOptions {
    std::string results, before; // JSON of sweeps; `before` is empty for a page instead of a comparison
    std::string folder = "docs/results/data", name = "speed-error";
};
void report(const ReportOptions& options);

} // namespace brume::bench
