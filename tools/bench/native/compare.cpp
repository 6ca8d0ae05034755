#include "tools/bench/native/compare.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdio>
#include <stdexcept>

#include <fmt/format.h>

#include "tools/bench/error.h"

namespace brume::bench {
namespace {

constexpr glm::uvec2 kSize{640, 360};
constexpr uint32_t kEvery = 5; // of the pixels that are compared with the reference

Case caseOf(const std::string& scene, const std::string& camera) {
    return {.scene = scene,
            // no ground, no lobe, no ambient light, every pixel interpolated and shaded, as in the native program
            .set = {"sky.zenith=[0,0,0]", "sky.horizon=[0,0,0]", "sky.ambient=[0,0,0]", "plane=[]",
                    "medium.anisotropy=0", "render.method=slabs", "render.shading=1"},
            .camera = camera,
            .size = kSize};
}

double msOf(const FrameCost& frame, const char* name) {
    double ms = 0;
    for (const FrameCost::Pass& pass : frame.passes)
        if (!pass.shared && pass.name == name) ms += pass.ms;
    return ms;
}

// The passes of Vulkan's slabs and the parts of the native ones that do the same.
enum { bin, slabs, light, rows, parts };
constexpr const char* kParts[parts] = {"bin", "slabs", "slab light", "reconstruct"};

struct Times {
    std::vector<double> whole, part[parts]; // ms, of each frame
    double least() const { return percentile(whole, 0); }
};

void addNative(NativeSlabs& native, Times& times) {
    const auto begin = std::chrono::steady_clock::now();
    native.render();
    times.whole.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    const NativeSlabs::Spent& spent = native.spent();
    const double each[parts] = {spent.bin, spent.slabs, spent.light, spent.rows};
    for (int p = 0; p < parts; ++p) times.part[p].push_back(each[p]);
}

// `display`: the least that compose takes of a medium that was drawn, ms.
void addVulkan(const FrameCost& frame, double display, Times& times) {
    times.whole.push_back(0);
    for (int p = 0; p < parts; ++p) {
        times.part[p].push_back(p == rows ? std::max(msOf(frame, "compose") - display, 0.0) + msOf(frame, "spline")
                                          : msOf(frame, kParts[p]));
        times.whole.back() += times.part[p].back();
    }
}

// As the plan counts Vulkan's, but of all particles.
double vulkanSamples(const Stage& stage, const RenderSettings& way) {
    PlanScene scene = planScene(stage.scene(), stage.simulation());
    scene.sample = stage.particles();
    const Work work = ViewWork(scene, {stage.pose(), kSize.x, kSize.y}).of(way);
    const auto adds = [](const CostInfo* cost) { return cost->key == std::string_view("slabs"); };
    return work[**std::find_if(allCosts().begin(), allCosts().end(), adds)];
}

double off(const RadianceImage& value, const RadianceImage& reference) {
    return 100 * mediumError(value, reference, {}).medium.relative_rmse; // %
}

} // namespace

std::string nativeTable(const gpu::Device& device, Truth& truth, const native::Kernel& kernel,
                        const NativeQuestion& question) {
    std::string table = "| scene, camera | rays, slabs | native, ms | median | Vulkan, ms | median | ratio | of "
                        "medians | from slabs, % | native, % | slabs, % "
                        "|\n|---|---|---|---|---|---|---|---|---|---|---|\n";
    std::string profile =
        "\nWhere it goes: least time of each part, and how many extinctions (particle, slab and ray) are "
        "computed.\n\n"
        "| scene, camera | part | native, ms | Vulkan, ms | ratio | native, million | Vulkan, million | native, ns "
        "each | Vulkan, ns each |\n|---|---|---|---|---|---|---|---|---|\n";
    Case drawn = caseOf("cloud", "outside");
    drawn.set.insert(drawn.set.end(), {"render.method=sphere", "medium.count=1"});
    Stage display(device, drawn);
    display.frame();
    for (const char* scene : {"cloud", "cloud-5000", "plume", "cumulus"})
        for (const char* camera : {"outside", "inside"}) {
            if (std::string_view(scene).find(question.only) == std::string_view::npos) continue;
            Case wanted = caseOf(scene, camera);
            RenderSettings way = Stage(device, wanted).plan().chosen.settings;
            way.rate = std::bit_floor(way.rate); // what NativeSlabs has
            wanted.set.push_back(fmt::format("render.rate={}", way.rate));
            wanted.set.push_back(fmt::format("render.slabs={}", way.slabs));
            Stage stage(device, wanted);
            NativeSlabs native(stage, kSize, way.rate, way.slabs, kernel, question.threads);
            stage.frame(); // compiles shaders, fits buffers
            native.render();
            Times own, vulkan;
            std::vector<FrameCost> all;
            double shown = 1e30;
            for (uint32_t i = 0; i < question.frames; ++i) {
                addNative(native, own);
                all.push_back(stage.frame());
                shown = std::min(shown, msOf(display.frame(), "compose"));
            }
            for (const FrameCost& frame : all) addVulkan(frame, shown, vulkan);
            const RadianceImage mine = native.picture(), theirs = stage.picture(stage.pose(), kSize);
            const RadianceImage exact = truth.of(stage, stage.pose(), kSize, kEvery);
            const double apart = off(mine, theirs);
            if (!(apart <= 100 * kNativeAgrees))
                throw std::runtime_error(
                    fmt::format("{}, {}: the native picture is {:.3g} % from that of slabs; allowed: {:.3g} %", scene,
                                camera, apart, 100 * kNativeAgrees));
            table += fmt::format("| {}, {} | {}x{}, {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.3f} "
                                 "| {:.3f} | {:.3f} |\n",
                                 scene, camera, way.rate, way.rate, way.slabs, own.least(), median(own.whole),
                                 vulkan.least(), median(vulkan.whole), vulkan.least() / own.least(),
                                 median(vulkan.whole) / median(own.whole), apart, off(thinned(mine, kEvery), exact),
                                 off(thinned(theirs, kEvery), exact));
            const double counted[] = {1e-6 * double(native.samples()), 1e-6 * vulkanSamples(stage, way)};
            for (int p = 0; p < parts; ++p) {
                const double a = percentile(own.part[p], 0), b = percentile(vulkan.part[p], 0);
                profile +=
                    fmt::format("| {}, {} | {} | {:.2f} | {:.2f} | {:.1f} |", scene, camera, kParts[p], a, b, b / a);
                profile += p == slabs ? fmt::format(" {:.1f} | {:.1f} | {:.3f} | {:.3f} |\n", counted[0], counted[1],
                                                    a / counted[0], b / counted[1])
                                      : " | | | |\n";
            }
            std::fprintf(stderr, "  %-10s %-8s native %7.2f ms, Vulkan %7.2f ms\n", scene, camera, own.least(),
                         vulkan.least());
        }
    return table + profile +
           "\nA particle costs the native program six exponentials of a vector (two of them of the recurrence's "
           "ratios) per tile and run of at most 16 slabs, then two multiplications a slab for a row and for a "
           "column of rays; the shader, whose lane is a slab, five exponentials and 32 multiplications a slab. "
           "Both keep the 64 sums of a slab in memory: they do not fit the registers.\n";
}

std::string nativeReport(const native::Kernel& kernel, const NativeRun& run, const std::string& table) {
    return fmt::format(
        "# Slabs on Vulkan beside the same maths written for the CPU\n\n"
        "Written by `{}` on {}. CPU: {}. Vulkan device: {}. Native instructions: {}, {} floats a vector.\n\n"
        "The native program ([`tools/bench/native`](../../../tools/bench/native)) does what the method `slabs` does "
        "to a medium that is lit already: bins, extinction of all slabs by recurrence, light along the rays, a "
        "cubic B-spline to radiance and transmittance of every pixel. Vulkan's time is that of the passes bin, "
        "slabs, slab light and spline, and of compose less what compose takes of a medium that was drawn (tone "
        "map, sRGB, YCbCr); frames of both alternate. Least of all frames, and median; the ratio is Vulkan's time "
        "over the native one's. The last columns are relative RMSE: of the native picture from that of `slabs`, "
        "and of both from the double-precision reference, every fifth pixel.\n\n{}",
        run.command, run.date, run.cpu, run.device, kernel.name, kernel.lanes, table);
}

} // namespace brume::bench
