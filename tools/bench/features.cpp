#include "tools/bench/features.h"

#include <cstdio>
#include <memory>
#include <span>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "common/metrics.h"

namespace brume::bench {
namespace {

constexpr glm::uvec2 kSize{640, 360};
constexpr std::string_view kMany = "cloud-5000";
// Relative RMSE. With objects, slabs end rays at a surface and keep a value for each slab: other roundings of the same
// sums. Drawn particles take the quadrature of intervals that a wall may cut: a tenth of what it leaves anyway.
double samePicture(std::string_view method) { return method == "sphere" || method == "isv" ? 2e-3 : 1e-4; }

struct Compiled {
    const char* name;
    SceneFeatures besides;
};
constexpr Compiled kCompiled[] = {
    {"what the scene has", {}},
    {"ambient light besides", {.ambient = true}},
    {"a lobe besides", {.lobe = true}},
    {"objects besides", {.opaque = true}},
    {"objects that cast shadows besides, and their shafts", {.opaque = true, .bodies = true, .casters = true}},
    {"all of that", {.opaque = true, .bodies = true, .casters = true, .ambient = true, .lobe = true}},
};
// Those that methods with a field have alone.
constexpr Compiled kOfFields[] = {
    {"what the scene has", {}},
    {"fog besides", {.fog = true}},
    {"points and spots besides", {.opaque = true, .local_lights = true}},
    {"meshes besides", {.opaque = true, .meshes = true}},
    {"objects that cast shadows besides, and their shafts", {.opaque = true, .bodies = true, .casters = true}},
};

struct Times {
    std::vector<double> medium, background; // ms of a frame: the view's passes but the opaque one, and that
};

constexpr const char* kHead = "| scene | method | compiled for | medium and compose, ms | over the first | opaque "
                              "pass, ms |\n|---|---|---|---|---|---|\n";

// A row for each of `all`, their frames in turns.
std::string rowsOf(const gpu::Device& device, uint32_t frames, std::string_view scene, std::string_view method,
                   std::span<const Compiled> all) {
    std::vector<std::unique_ptr<Stage>> stages;
    for (const Compiled& compiled : all) {
        Case wanted{.scene = std::string(scene),
                    .set = {"render.method=" + std::string(method)},
                    .camera = "outside",
                    .size = kSize};
        wanted.besides = compiled.besides;
        stages.push_back(std::make_unique<Stage>(device, wanted));
        stages.back()->frame(); // compiles shaders, fits buffers
    }
    std::vector<Times> times(stages.size());
    for (uint32_t i = 0; i < frames; ++i)
        for (size_t s = 0; s < stages.size(); ++s) {
            double medium = 0, background = 0;
            for (const FrameCost::Pass& pass : stages[s]->frame().passes)
                if (!pass.shared) (pass.name == "opaque" ? background : medium) += pass.ms;
            times[s].medium.push_back(medium), times[s].background.push_back(background);
        }
    const RadianceImage plain = stages.front()->picture(stages.front()->pose(), kSize);
    std::string out;
    for (size_t s = 0; s < stages.size(); ++s) {
        const double apart = compare(stages[s]->picture(stages[s]->pose(), kSize), plain, {}).relative_rmse;
        if (!(apart <= samePicture(method)))
            throw std::runtime_error(fmt::format("{}, {}: compiled for {} the picture changes by {:.3g}", scene, method,
                                                 all[s].name, apart));
        const double least = percentile(times[s].medium, 0);
        out += fmt::format("| {} | {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", scene, method, all[s].name, least,
                           least / percentile(times[0].medium, 0), percentile(times[s].background, 0));
    }
    std::fprintf(stderr, "  %-10s %-7s %8.2f ms, compiled for the last %8.2f ms\n", std::string(scene).c_str(),
                 std::string(method).c_str(), percentile(times.front().medium, 0), percentile(times.back().medium, 0));
    return out;
}

} // namespace

std::string featuresTable(const gpu::Device& device, uint32_t frames) {
    std::string out = kHead;
    for (const std::string_view scene : {std::string_view("cloud"), kMany})
        for (const std::string_view method : {"slabs", "tiles", "sphere", "isv"}) {
            if (scene == kMany && (method == "sphere" || method == "isv"))
                continue; // as on the other, ten times slower
            out += rowsOf(device, frames, scene, method, kCompiled);
        }
    return out + "\nWhat `slabs` and `grid` alone draw:\n\n" + absentFeatures(device, frames);
}

std::string absentFeatures(const gpu::Device& device, uint32_t frames) {
    std::string out = kHead;
    for (const std::string_view method : {"slabs", "grid"}) out += rowsOf(device, frames, "cloud", method, kOfFields);
    return out;
}

} // namespace brume::bench
