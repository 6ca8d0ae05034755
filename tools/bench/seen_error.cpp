#include "tools/bench/seen_error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/bench/error.h"

namespace brume::bench {
namespace {

using nlohmann::json;

constexpr double kSeam = 0.01;        // part of the luminance from which a kink counts
constexpr double kDark = 0.01;        // part of the largest luminance below which a pixel does not count
constexpr float kShowsMedium = 0.99f; // transmittance

std::vector<double> luminances(const RadianceImage& image) {
    std::vector<double> all;
    for (const glm::vec3& pixel : image.radiance)
        all.push_back(0.2126 * double(pixel.r) + 0.7152 * double(pixel.g) + 0.0722 * double(pixel.b));
    return all;
}

// The kinks of pixels that count.
std::vector<double> kinks(const RadianceImage& seen, const RadianceImage& whole) {
    const std::vector<double> a = luminances(seen), b = luminances(whole);
    const double dark = kDark * *std::ranges::max_element(a);
    const auto width = size_t(whole.width), height = size_t(whole.height);
    std::vector<double> all;
    for (size_t y = 1; y + 1 < height; ++y)
        for (size_t x = 1; x + 1 < width; ++x) {
            const size_t i = y * width + x;
            double mean = 0;
            for (size_t row = i - width; row <= i + width; row += width) mean += (a[row - 1] + a[row] + a[row + 1]) / 9;
            if (mean < dark || seen.transmittance[i] > kShowsMedium) continue;
            const auto bend = [&](size_t step) {
                const auto of = [&](const std::vector<double>& v) { return v[i - step] - 2 * v[i] + v[i + step]; };
                return std::abs(of(a) - of(b));
            };
            all.push_back(std::max(bend(1), bend(width)) / mean);
        }
    return all;
}

Case with(Case wanted, std::initializer_list<const char*> set) {
    wanted.set.insert(wanted.set.end(), set.begin(), set.end());
    return wanted;
}

// Particles around the view axis are pushed, and move from the first frame on.
std::vector<RadianceImage> moving(Stage& stage, glm::uvec2 size, uint32_t frames) {
    const Pose& pose = stage.pose();
    const Command pushed{.body = Impulse{pose.position, pose.orientation * glm::vec3(0, 0, -1)}};
    std::vector<RadianceImage> all;
    for (uint32_t i = 0; i < frames; ++i) {
        stage.step({&pushed, i == 0 ? 1u : 0u});
        all.push_back(stage.picture(pose, size));
    }
    return all;
}

json rowOf(const SeenCase& one) {
    return {{"scene", one.wanted.scene}, {"camera", one.wanted.camera}, {"variant", one.name}, {"set", one.wanted.set}};
}

} // namespace

json seamRows(const gpu::Device& device, const std::vector<SeenCase>& cases, glm::uvec2 size, uint32_t ticks) {
    json rows = json::array();
    for (const SeenCase& one : cases) {
        Stage stage(device, one.wanted, ticks), whole(device, with(one.wanted, {"render.method=sphere"}), ticks);
        const std::vector<double> all = kinks(stage.picture(stage.pose(), size), whole.picture(whole.pose(), size));
        const auto seams = std::ranges::count_if(all, [](double kink) { return kink > kSeam; });
        json row = rowOf(one);
        row.update({{"pixels", all.size()},
                    {"kink_median", median(all)},
                    {"kink_p99", percentile(all, 0.99)},
                    {"seams", double(seams) / double(std::max<size_t>(all.size(), 1))}});
        std::fprintf(stderr, "  %-12s %-8s seams %-32s %.3f %% of pixels, p99 %.3f %%\n", one.wanted.scene.c_str(),
                     one.wanted.camera.c_str(), one.name.c_str(), 100 * row["seams"].get<double>(),
                     100 * row["kink_p99"].get<double>());
        rows.push_back(std::move(row));
    }
    return rows;
}

json motionRows(const gpu::Device& device, const std::vector<SeenCase>& cases, glm::uvec2 size, uint32_t frames,
                uint32_t ticks) {
    // Cases are alike but for the map.
    Stage finest(device, with(cases.front().wanted, {"render.shadow_size=512", "render.shadow_slices=128"}), ticks);
    const std::vector<RadianceImage> exact = moving(finest, size, frames);
    json rows = json::array();
    for (const SeenCase& one : cases) {
        Stage stage(device, one.wanted, ticks);
        const std::vector<RadianceImage> seen = moving(stage, size, frames);
        const DisplaySettings display = displayOf(stage.scene().render);
        std::vector<std::vector<double>> errors;
        double flicker = 0, values = 0;
        for (uint32_t i = 0; i < frames; ++i) {
            const std::vector<double> a = luminances(seen[i]), b = luminances(exact[i]);
            std::vector<double>& of_frame = errors.emplace_back();
            for (size_t p = 0; p < a.size(); ++p) of_frame.push_back(a[p] - b[p]), values += b[p] * b[p];
            if (i < 2) continue;
            for (size_t p = 0; p < a.size(); ++p) {
                const double bend = errors[i - 2][p] - 2 * errors[i - 1][p] + errors[i][p];
                flicker += bend * bend;
            }
        }
        json row = rowOf(one);
        row.update({{"frames", frames},
                    {"temporal_flip", temporalFlip(seen, exact, display)},
                    {"flicker", std::sqrt(flicker / (frames - 2) / (values / frames))},
                    {"relative_rmse", mediumError(seen.back(), exact.back(), display).medium.relative_rmse}});
        std::fprintf(stderr, "  %-12s %-8s motion %-20s error %.4f %%, flicker %.5f %%, FLIP %.6f\n",
                     one.wanted.scene.c_str(), one.wanted.camera.c_str(), one.name.c_str(),
                     100 * row["relative_rmse"].get<double>(), 100 * row["flicker"].get<double>(),
                     row["temporal_flip"].get<double>());
        rows.push_back(std::move(row));
    }
    return rows;
}

} // namespace brume::bench
