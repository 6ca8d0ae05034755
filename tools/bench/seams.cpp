#include "tools/bench/seams.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

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

json rowOf(const NamedCase& one) {
    return {{"scene", one.wanted.scene}, {"camera", one.wanted.camera}, {"variant", one.name}, {"set", one.wanted.set}};
}

} // namespace

json seamRows(const gpu::Device& device, const std::vector<NamedCase>& cases, glm::uvec2 size, uint32_t ticks) {
    json rows = json::array();
    for (const NamedCase& one : cases) {
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

} // namespace brume::bench
