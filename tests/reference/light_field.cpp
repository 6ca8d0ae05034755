#include "tests/reference/light_field.h"

#include <algorithm>
#include <cmath>

namespace brume::reference {

namespace {
constexpr double kSqrtPi = 1.77245385090551602730;
}

std::vector<Blob> blobsOf(std::span<const gpu::Particle> particles, double falloff) {
    std::vector<Blob> blobs;
    blobs.reserve(particles.size());
    for (const gpu::Particle& p : particles) {
        const double k = std::sqrt(50.0) / (p.scale * falloff);
        blobs.push_back({p.centre, p.scale, k, p.sigma_t, p.sigma_t * kSqrtPi / (2 * k), p.albedo});
    }
    return blobs;
}

LightField::LightField(std::span<const Blob> blobs, glm::dvec3 to_light) : to_light_(to_light) {
    x_axis_ = glm::normalize(glm::cross(to_light, std::abs(to_light.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    y_axis_ = glm::cross(to_light, x_axis_);
    if (blobs.empty()) return;

    double hi_x = -1e300, hi_y = -1e300, reach_sum = 0;
    lo_x_ = lo_y_ = 1e300;
    for (const Blob& b : blobs) {
        const Shade shade{
            dot(b.centre, x_axis_), dot(b.centre, y_axis_), dot(b.centre, to_light_), b.k, b.half_line, kReach / b.k};
        shades_.push_back(shade);
        lo_x_ = std::min(lo_x_, shade.x - shade.reach);
        lo_y_ = std::min(lo_y_, shade.y - shade.reach);
        hi_x = std::max(hi_x, shade.x + shade.reach);
        hi_y = std::max(hi_y, shade.y + shade.reach);
        reach_sum += shade.reach;
    }
    std::sort(shades_.begin(), shades_.end(), [](const Shade& a, const Shade& b) { return a.s + a.reach > b.s + b.reach; });

    cell_ = std::max({reach_sum / static_cast<double>(blobs.size()) / 4, (hi_x - lo_x_) / 512, (hi_y - lo_y_) / 512});
    cells_x_ = static_cast<int>((hi_x - lo_x_) / cell_) + 1;
    cells_y_ = static_cast<int>((hi_y - lo_y_) / cell_) + 1;
    std::vector<std::vector<uint32_t>> lists(static_cast<size_t>(cells_x_) * cells_y_);
    for (uint32_t i = 0; i < shades_.size(); ++i) {
        const Shade& shade = shades_[i];
        const auto cellOf = [&](double at, double lo, int cells) {
            return std::clamp(static_cast<int>((at - lo) / cell_), 0, cells - 1);
        };
        const int x1 = cellOf(shade.x + shade.reach, lo_x_, cells_x_), y1 = cellOf(shade.y + shade.reach, lo_y_, cells_y_);
        for (int y = cellOf(shade.y - shade.reach, lo_y_, cells_y_); y <= y1; ++y)
            for (int x = cellOf(shade.x - shade.reach, lo_x_, cells_x_); x <= x1; ++x)
                lists[static_cast<size_t>(y) * cells_x_ + x].push_back(i);
    }
    first_.push_back(0);
    for (const auto& list : lists) {
        listed_.insert(listed_.end(), list.begin(), list.end());
        first_.push_back(static_cast<uint32_t>(listed_.size()));
    }
}

double LightField::depth(glm::dvec3 point) const {
    const double x = dot(point, x_axis_), y = dot(point, y_axis_), s = dot(point, to_light_);
    const double cx = (x - lo_x_) / cell_, cy = (y - lo_y_) / cell_;
    if (!(cx >= 0 && cx < cells_x_ && cy >= 0 && cy < cells_y_)) return 0;
    const size_t cell = static_cast<size_t>(cy) * cells_x_ + static_cast<size_t>(cx);
    double sum = 0;
    for (uint32_t j = first_[cell]; j < first_[cell + 1]; ++j) {
        const Shade& shade = shades_[listed_[j]];
        if (shade.s + shade.reach <= s) break; // this one and all later ones lie behind the point
        const double b2 = (x - shade.x) * (x - shade.x) + (y - shade.y) * (y - shade.y);
        if (b2 >= shade.reach * shade.reach) continue;
        const double ks = shade.k * (s - shade.s);
        sum += shade.half_line * std::exp(-shade.k * shade.k * b2) * (ks < -kReach ? 2 : std::erfc(ks));
    }
    return sum;
}

} // namespace brume::reference
