#include "server/sim/sequence_files.h"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "common/numbered_files.h"
#include "common/random.h"
#include "common/scene_limits.h"
#include "common/text.h"
#include "server/sim/point_cloud.h"
#include "server/sim/state_hash.h"

namespace brume {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
    throw SceneError(oneLine(file.string() + ": " + what));
}

// What the points of a file come with, besides their places.
std::string propertiesOf(const Placement& placed) {
    return fmt::format("{}, {}, {}, {}", placed.own_scale ? placed.cloud->sizes_from : "no sizes",
                       placed.cloud->extinctions_from, placed.cloud->coloured ? "colours" : "no colours",
                       placed.velocity.empty() ? "no velocities" : "velocities");
}

template <class T>
void reorder(std::vector<T>& list, const std::vector<uint32_t>& order) {
    if (list.empty()) return;
    std::vector<T> out;
    out.reserve(list.size());
    for (const uint32_t i : order) out.push_back(list[i]);
    list = std::move(out);
}

void sortById(SequenceFile& file, const std::filesystem::path& path) {
    std::vector<uint32_t> order(file.id.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return file.id[a] < file.id[b]; });
    const auto twice = std::adjacent_find(order.begin(), order.end(),
                                          [&](uint32_t a, uint32_t b) { return file.id[a] == file.id[b]; });
    if (twice != order.end())
        fail(path, fmt::format("PLY: property id: points {} and {} are both number {}; expected a number for each",
                               twice[0] + 1, twice[1] + 1, file.id[twice[0]]));
    reorder(file.position, order);
    reorder(file.scale, order);
    reorder(file.weight, order);
    reorder(file.albedo, order);
    reorder(file.velocity, order);
    reorder(file.id, order);
}

uint64_t bytesOf(const SequenceFile& file) {
    return (file.position.size() + file.albedo.size() + file.velocity.size()) * sizeof(glm::vec3) +
           (file.scale.size() + file.weight.size()) * sizeof(float) + file.id.size() * sizeof(int64_t);
}

// Numbers of the scene's own ranges belong to a point's id or, without one, to its row: they are the same in all files.
SequenceFile fileOf(uint64_t number, Placement&& placed, const Medium& medium) {
    SequenceFile out{number,
                     std::move(placed.position),
                     std::move(placed.scale),
                     std::move(placed.sigma_t),
                     std::move(placed.albedo),
                     std::move(placed.id),
                     std::move(placed.velocity)};
    const bool own_extinction = !out.weight.empty();
    for (size_t i = 0; i < out.position.size(); ++i) {
        out.position[i] += medium.centre;
        Random random(medium.seed, out.id.empty() ? i : static_cast<uint64_t>(out.id[i]));
        const float scale = random.uniform(medium.scale.lo, medium.scale.hi);
        if (!placed.own_scale) out.scale[i] = scale;
        if (!own_extinction) out.weight.push_back(random.uniform(medium.multiplier.lo, medium.multiplier.hi) * 1e-4f);
    }
    return out;
}

uint64_t hashOf(const SequenceFiles& all, const Medium& medium) {
    StateHash hash;
    hash.add(std::span(&medium.rate, 1));
    hash.add(uint64_t{medium.loop});
    for (const SequenceFile& file : all.files) {
        hash.add(file.number);
        hash.add(uint64_t{file.position.size()});
        if (!file.position.empty()) hash.add(std::span(&file.position[0].x, 3 * file.position.size()));
        hash.add(file.scale);
        hash.add(file.weight);
        if (!file.albedo.empty()) hash.add(std::span(&file.albedo[0].x, 3 * file.albedo.size()));
        if (!file.velocity.empty()) hash.add(std::span(&file.velocity[0].x, 3 * file.velocity.size()));
        for (const int64_t id : file.id) hash.add(static_cast<uint64_t>(id));
    }
    return hash.value();
}

// What the line about the sequence says.
std::string textOf(const SequenceFiles& all, const Medium& medium, const std::string& without_ids) {
    const uint64_t first = all.files.front().number, last = all.files.back().number;
    const auto count = [](const SequenceFile& a, const SequenceFile& b) {
        return a.position.size() < b.position.size();
    };
    const auto [few, many] = std::minmax_element(all.files.begin(), all.files.end(), count);
    const size_t least = few->position.size(), most = many->position.size();
    return fmt::format("{} files, {} to {}, in {:.4g} s, {}; {} points; {}", all.files.size(), first, last,
                       static_cast<double>(last - first + 1) / static_cast<double>(medium.rate),
                       medium.loop ? "again and again" : "once",
                       least < most ? fmt::format("{} to {}", least, most) : fmt::format("{}", least),
                       all.has_velocities ? "they move by their velocities"
                       : all.has_ids      ? "they move by their ids"
                                          : "each file is shown until the next, as '" + without_ids +
                                           "' has no property id of whole numbers");
}

std::string gapsOf(const SequenceFiles& all, const std::filesystem::path& pattern) {
    const uint64_t first = all.files.front().number, last = all.files.back().number;
    const uint64_t missing = last - first + 1 - all.files.size();
    if (missing == 0) return {};
    uint64_t gap = first;
    for (const SequenceFile& file : all.files) {
        if (file.number != gap) break;
        ++gap;
    }
    return fmt::format("sequence '{}': {} numbers between {} and {} have no file, the first is {}: the file before "
                       "each lasts longer",
                       pattern.string(), missing, first, last, gap);
}

} // namespace

SequenceFiles loadSequence(const Medium& medium, glm::dvec3 origin, uint64_t most_bytes) {
    SequenceFiles out;
    Medium one = medium;
    std::string properties, without_ids;
    float by_depth = 0; // extinction of all points, where none came
    const auto files = numberedFiles(medium.file);
    for (const auto& [number, path] : files) {
        one.file = path;
        Placement placed = placePointCloud(one, origin);
        if (placed.position.empty()) { // a moment without anything
            out.files.push_back(
                {.number = number, .position = {}, .scale = {}, .weight = {}, .albedo = {}, .id = {}, .velocity = {}});
            continue;
        }
        if (placed.cloud->by_depth) {
            if (out.most == 0) by_depth = placed.sigma_t.front();
            placed.sigma_t.assign(placed.position.size(), by_depth);
        }
        if (out.most == 0) {
            properties = propertiesOf(placed);
            out.facts = *placed.cloud;
            out.own_extinction = !placed.sigma_t.empty();
            if (one.scale_by_spacing && !placed.own_scale) one.scale = {placed.scale[0], placed.scale[0]};
            one.scale_by_spacing = false; // the others' points are as large as those of the first
        } else {
            if (propertiesOf(placed) != properties)
                fail(path,
                     fmt::format("PLY: {}; the first file of the sequence has: {}", propertiesOf(placed), properties));
            if (out.facts.dropped == 0 && placed.cloud->dropped > 0)
                out.facts.first_dropped = path.filename().string() + ", " + placed.cloud->first_dropped;
            out.facts.dropped += placed.cloud->dropped;
            out.facts.kept += placed.cloud->kept;
        }
        if (placed.id.empty() && without_ids.empty()) without_ids = path.filename().string();
        SequenceFile file = fileOf(number, std::move(placed), one);
        if (!file.id.empty()) sortById(file, path);
        out.most = std::max(out.most, static_cast<uint32_t>(file.position.size()));
        out.bytes += bytesOf(file);
        if (out.bytes > most_bytes)
            fail(medium.file, fmt::format("the first {} of {} files hold {} MiB of points, --memory allows {}: use "
                                          "fewer files or allow more",
                                          out.files.size() + 1, files.size(), out.bytes >> 20, most_bytes >> 20));
        out.files.push_back(std::move(file));
    }
    if (out.most == 0) fail(medium.file, "no file has a point; allowed: files without points beside others");
    out.has_velocities =
        std::ranges::any_of(out.files, [](const SequenceFile& file) { return !file.velocity.empty(); });
    out.has_ids = without_ids.empty() && !out.has_velocities;
    for (size_t i = 1; out.has_velocities && i < out.files.size(); ++i) // one fades into the other
        out.most = std::max(out.most, uint32_t(out.files[i - 1].position.size() + out.files[i].position.size()));
    if (double(out.most) > limits::kCount.hi)
        fail(medium.file, fmt::format("two files one after the other have {} points with velocities, which are shown "
                                      "together; allowed: {:.0f}",
                                      out.most, limits::kCount.hi));
    for (SequenceFile& file : out.files)
        if (!out.has_ids) {
            out.bytes -= file.id.size() * sizeof(int64_t);
            file.id = {};
        }
    out.hash = hashOf(out, medium);
    out.facts.sequence = textOf(out, medium, without_ids);
    out.facts.gaps = gapsOf(out, medium.file);
    return out;
}

Scene standIn(Scene scene) {
    Medium& medium = scene.medium;
    if (medium.layout == Layout::sequence) {
        medium.layout = Layout::file;
        medium.file = firstWithPoints(medium.file);
    } else if (medium.layout == Layout::live) {
        medium.layout = Layout::cube;
        medium.count = std::min(medium.count, Medium().count);
    }
    if (medium.extinction <= 0) medium.extinction = Medium().extinction; // else nothing is drawn, and no shader is made
    return scene;
}

} // namespace brume
