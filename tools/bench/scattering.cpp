#include "tools/bench/scattering.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "tools/bench/error.h"
#include "tools/bench/truth.h"
#include "tools/random_scene/random_scene.h"

namespace brume::bench {
namespace {

constexpr uint32_t kFirstPaths = 16; // by which the noise and the time of more are foretold
constexpr size_t kLeastPixels = 50;
constexpr double kMostNoise = 0.25; // more is not taken out well: few paths carry most of the light

double sumOf(glm::dvec3 v) { return v.x + v.y + v.z; }

// Paths through every pixel: as many as the question's noise takes, but no more than its limits.
reference::TrackedPicture pathsOf(const Stage& stage, const ScatteringQuestion& question, glm::uvec2 size,
                                  std::span<const uint8_t> mask, uint32_t& paths) {
    const auto begin = std::chrono::steady_clock::now();
    reference::TrackedPicture first = tracked(stage, stage.pose(), size, kFirstPaths);
    const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    const double noise = noiseOf(first, mask); // not a number where no path brings light
    const double wanted = std::isfinite(noise) ? kFirstPaths * std::pow(noise / question.noise, 2) : kFirstPaths;
    const double most = std::min(double(question.paths), kFirstPaths * question.seconds / took);
    paths = uint32_t(std::max(std::min(wanted, most), double(kFirstPaths)));
    return paths == kFirstPaths ? first : tracked(stage, stage.pose(), size, int(paths));
}

// Pixels of the medium without edges of objects and shadows, where a picture has the mean of a pixel and a path has its
// middle.
std::vector<uint8_t> maskOf(const Stage& stage, const ScatteringQuestion& question, const RadianceImage& picture,
                            size_t objects) {
    std::vector<uint8_t> mask = mediumMask(picture, 5e-4f);
    if (objects == 0) return mask;
    const RadianceImage truth =
        Truth(question.references).of(stage, stage.pose(), {uint32_t(picture.width), uint32_t(picture.height)});
    for (size_t i = 0; i < mask.size(); ++i) mask[i] = mask[i] && !truth.edges[i];
    return mask;
}

// The line of the page's table that a scene counts in.
std::string groupOf(const ScatteringRow& row) {
    if (row.objects > 0) return "with objects, any";
    return row.depth < 0.3 ? "below 0.3" : row.depth < 3 ? "0.3 to 3" : "3 and more";
}

} // namespace

ScatteringError scatteringError(const RadianceImage& picture, const reference::TrackedPicture& truth,
                                std::span<const uint8_t> mask) {
    double errors = 0, noise = 0, squares = 0, got = 0, exact = 0;
    for (size_t i = 0; i < mask.size(); ++i) {
        if (!mask[i]) continue;
        const glm::dvec3 value(picture.radiance[i]), true_one = truth.radiance[i], se = truth.standard_error[i];
        errors += glm::dot(value - true_one, value - true_one), noise += glm::dot(se, se);
        squares += glm::dot(true_one, true_one), got += sumOf(value), exact += sumOf(true_one);
    }
    return {std::sqrt(std::max(errors - noise, 0.0) / squares), got / exact - 1};
}

double noiseOf(const reference::TrackedPicture& truth, std::span<const uint8_t> mask) {
    double noise = 0, squares = 0;
    for (size_t i = 0; i < mask.size(); ++i) {
        if (!mask[i]) continue;
        noise += glm::dot(truth.standard_error[i], truth.standard_error[i]);
        squares += glm::dot(truth.radiance[i], truth.radiance[i]);
    }
    return std::sqrt(noise / squares);
}

ScatteringRow scatteringRow(const gpu::Device& device, const CostModel& model, const ScatteringQuestion& question,
                            uint64_t seed) {
    ScatteringRow row;
    row.seed = seed;
    try {
        const RandomScene random = randomScene(seed);
        row.layout = random.layout, row.camera = random.camera, row.depth = random.depth;
        row.particles = random.points.position.size();
        row.objects = random.scene.boxes.size() + random.scene.spheres.size() + random.scene.planes.size();
        for (const glm::vec3& albedo : random.points.albedo)
            row.albedo += double(albedo.x + albedo.y + albedo.z) / (3 * double(row.particles));
        Case wanted{.scene = save(random, question.folder).string()};
        wanted.size = {question.width, question.width * 9 / 16};
        wanted.set = {std::begin(kMediumAlone), std::end(kMediumAlone)};
        wanted.set.emplace_back();
        std::vector<uint8_t> mask;
        reference::TrackedPicture truth;
        for (size_t i = 0; i < kModels.size(); ++i) {
            wanted.set.back() = fmt::format("render.scattering={}", kModels[i]);
            Stage stage(device, wanted, 0, model);
            const RadianceImage picture = stage.picture(stage.pose(), wanted.size);
            if (i == 0) {
                mask = maskOf(stage, question, picture, row.objects);
                if (size_t(std::ranges::count(mask, 1)) < kLeastPixels)
                    return row.why_not = "the camera sees little of the medium", row;
                row.promised = stage.plan().within;
                truth = pathsOf(stage, question, wanted.size, mask, row.paths);
                row.noise = noiseOf(truth, mask);
                if (!(row.noise < kMostNoise)) return row.why_not = "the paths are too noisy", row;
            }
            row.errors[i] = scatteringError(picture, truth, mask);
        }
    } catch (const std::exception& e) { // one scene's failure is a result, and does not end the others
        row.why_not = e.what();
    }
    return row;
}

std::string scatteringPage(std::span<const ScatteringRow> rows) {
    std::string out = "| optical depth | scenes |";
    for (const char* model : kModels) out += fmt::format(" `{}`: median RMSE | worst | median bias |", model);
    out += "\n|---|---|---|---|---|---|---|---|---|---|---|\n";
    for (const char* group : {"below 0.3", "0.3 to 3", "3 and more", "with objects, any"}) {
        std::vector<double> rmse[kModels.size()], bias[kModels.size()];
        for (const ScatteringRow& row : rows) {
            if (!row.promised || !row.why_not.empty() || groupOf(row) != group) continue;
            for (size_t i = 0; i < kModels.size(); ++i)
                rmse[i].push_back(row.errors[i].rmse), bias[i].push_back(row.errors[i].bias);
        }
        if (rmse[0].empty()) continue;
        out += fmt::format("| {} | {} |", group, rmse[0].size());
        for (size_t i = 0; i < kModels.size(); ++i)
            out += fmt::format(" {:.3g} % | {:.3g} % | {:+.3g} % |", 100 * median(rmse[i]),
                               100 * std::ranges::max(rmse[i]), 100 * median(bias[i]));
        out += '\n';
    }
    out += "\n| seed | scene | depth | albedo | paths | noise |";
    for (const char* model : kModels) out += fmt::format(" `{}` |", model);
    out += "\n|---|---|---|---|---|---|---|---|---|\n";
    for (const ScatteringRow& row : rows) {
        out += fmt::format("| {} | {}, {}, {} particles, {} objects{} | {:.3g} | {:.2g} |", row.seed, row.layout,
                           row.camera, row.particles, row.objects,
                           row.promised || !row.why_not.empty() ? "" : "; no promise", row.depth, row.albedo);
        if (!row.why_not.empty()) {
            out += fmt::format(" not measured: {} | | | | |\n", row.why_not);
            continue;
        }
        out += fmt::format(" {} | {:.2g} % |", row.paths, 100 * row.noise);
        for (const ScatteringError& error : row.errors)
            out += fmt::format(" {:.3g} %, {:+.3g} % |", 100 * error.rmse, 100 * error.bias);
        out += '\n';
    }
    return out;
}

} // namespace brume::bench
