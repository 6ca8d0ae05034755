#include "tools/reference/light_field.h"

#include <algorithm>
#include <cmath>

namespace brume::reference {

namespace {

void index(const std::vector<std::vector<uint32_t>>& lists, std::vector<uint32_t>& first,
           std::vector<uint32_t>& listed) {
    first.push_back(0);
    for (const auto& list : lists) {
        listed.insert(listed.end(), list.begin(), list.end());
        first.push_back(static_cast<uint32_t>(listed.size()));
    }
}

// Directions on the square [-1, 1]^2 unfolded from an octahedron; with an even number of cells a side its creases run
// along edges and diagonals of cells, so that no point of a cell is farther from its centre than its corners are.
constexpr int kOctahedron = 32;

glm::dvec2 toSquare(glm::dvec3 w) {
    const glm::dvec3 a = glm::abs(w);
    const glm::dvec2 p = glm::dvec2(w) / (a.x + a.y + a.z);
    if (w.z >= 0) return p;
    return {(1 - std::abs(p.y)) * std::copysign(1.0, p.x), (1 - std::abs(p.x)) * std::copysign(1.0, p.y)};
}

glm::dvec3 fromSquare(glm::dvec2 p) {
    const double z = 1 - std::abs(p.x) - std::abs(p.y);
    if (z < 0) p = {(1 - std::abs(p.y)) * std::copysign(1.0, p.x), (1 - std::abs(p.x)) * std::copysign(1.0, p.y)};
    return glm::normalize(glm::dvec3(p, z));
}

double angleBetween(glm::dvec3 a, glm::dvec3 b) { return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)); }

} // namespace

LightField::LightField(std::span<const Blob> blobs, glm::dvec3 to_light, double reach, double cells,
                       std::span<const SemiAxes> axes)
    : to_light_(to_light) {
    x_axis_ =
        glm::normalize(glm::cross(to_light, std::abs(to_light.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0)));
    y_axis_ = glm::cross(to_light, x_axis_);
    if (blobs.empty()) return;

    double hi_x = -1e300, hi_y = -1e300, reach_sum = 0;
    lo_x_ = lo_y_ = 1e300;
    for (size_t i = 0; i < blobs.size(); ++i) {
        const Blob& b = blobs[i];
        if (!axes.empty()) shaped_.push_back({b, axes[i]});
        const Shade shade{
            dot(b.centre, x_axis_), dot(b.centre, y_axis_), dot(b.centre, to_light_), b.k, b.half_line, reach / b.k};
        shades_.push_back(shade);
        lo_x_ = std::min(lo_x_, shade.x - shade.reach);
        lo_y_ = std::min(lo_y_, shade.y - shade.reach);
        hi_x = std::max(hi_x, shade.x + shade.reach);
        hi_y = std::max(hi_y, shade.y + shade.reach);
        reach_sum += shade.reach;
    }
    std::sort(shades_.begin(), shades_.end(),
              [](const Shade& a, const Shade& b) { return a.s + a.reach > b.s + b.reach; });
    std::sort(shaped_.begin(), shaped_.end(), [&](const ShapedBlob& a, const ShapedBlob& b) {
        return dot(a.blob.centre, to_light_) + reach / a.blob.k > dot(b.blob.centre, to_light_) + reach / b.blob.k;
    });

    cell_ =
        std::max({reach_sum / static_cast<double>(blobs.size()) / cells, (hi_x - lo_x_) / 512, (hi_y - lo_y_) / 512});
    cells_x_ = static_cast<int>((hi_x - lo_x_) / cell_) + 1;
    cells_y_ = static_cast<int>((hi_y - lo_y_) / cell_) + 1;
    std::vector<std::vector<uint32_t>> lists(static_cast<size_t>(cells_x_) * cells_y_);
    for (uint32_t i = 0; i < shades_.size(); ++i) {
        const Shade& shade = shades_[i];
        const auto cellOf = [&](double at, double lo, int count) {
            return std::clamp(static_cast<int>((at - lo) / cell_), 0, count - 1);
        };
        const int x1 = cellOf(shade.x + shade.reach, lo_x_, cells_x_),
                  y1 = cellOf(shade.y + shade.reach, lo_y_, cells_y_);
        for (int y = cellOf(shade.y - shade.reach, lo_y_, cells_y_); y <= y1; ++y)
            for (int x = cellOf(shade.x - shade.reach, lo_x_, cells_x_); x <= x1; ++x) {
                const double dx = std::max({lo_x_ + x * cell_ - shade.x, shade.x - lo_x_ - (x + 1) * cell_, 0.0});
                const double dy = std::max({lo_y_ + y * cell_ - shade.y, shade.y - lo_y_ - (y + 1) * cell_, 0.0});
                if (dx * dx + dy * dy < shade.reach * shade.reach)
                    lists[static_cast<size_t>(y) * cells_x_ + x].push_back(i);
            }
    }
    index(lists, first_, listed_);
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
        if (!shaped_.empty()) {
            const ShapedBlob& shaped = shaped_[listed_[j]];
            const BlobOnLine on = onLine(shaped.blob, &shaped.axes, point, to_light_);
            sum += on.half_line * std::exp(-on.k * on.k * on.b2) * (1 + table_.erf(on.k * on.closest));
            continue;
        }
        sum += shade.half_line * std::exp(-shade.k * shade.k * b2) * (1 - table_.erf(shade.k * (s - shade.s)));
    }
    return sum;
}

PointField::PointField(std::span<const Blob> blobs, glm::dvec3 position, double reach, std::span<const SemiAxes> axes)
    : position_(position) {
    for (const Blob& b : blobs) shades_.push_back({b.centre, b.k, b.half_line, reach / b.k});
    for (size_t i = 0; i < axes.size(); ++i) shaped_.push_back({blobs[i], axes[i]});
    std::vector<std::vector<uint32_t>> lists(size_t{kOctahedron} * kOctahedron);
    for (int y = 0; y < kOctahedron; ++y)
        for (int x = 0; x < kOctahedron; ++x) {
            const auto direction = [&](double u, double v) {
                return fromSquare({2 * (x + u) / kOctahedron - 1, 2 * (y + v) / kOctahedron - 1});
            };
            const glm::dvec3 middle = direction(0.5, 0.5);
            double size = 0;
            for (const auto& [u, v] : {std::pair{0, 0}, {0, 1}, {1, 0}, {1, 1}})
                size = std::max(size, angleBetween(middle, direction(u, v)));
            for (uint32_t i = 0; i < shades_.size(); ++i) {
                const glm::dvec3 toward = shades_[i].centre - position;
                const double distance = glm::length(toward);
                if (distance <= shades_[i].reach ||
                    angleBetween(middle, toward) <= size + std::asin(shades_[i].reach / distance) + 1e-9)
                    lists[static_cast<size_t>(y) * kOctahedron + x].push_back(i);
            }
        }
    index(lists, first_, listed_);
}

double PointField::depth(glm::dvec3 point) const {
    const glm::dvec3 away = point - position_;
    const double distance = glm::length(away);
    if (!(distance > 0)) return 0;
    const glm::dvec3 w = away / distance;
    const glm::ivec2 at = glm::clamp(glm::ivec2((toSquare(w) + 1.0) * (kOctahedron / 2.0)), 0, kOctahedron - 1);
    const size_t cell = static_cast<size_t>(at.y) * kOctahedron + at.x;
    double sum = 0;
    for (uint32_t j = first_[cell]; j < first_[cell + 1]; ++j) {
        const Shade& shade = shades_[listed_[j]];
        const glm::dvec3 toward = shade.centre - position_;
        const double closest = glm::dot(toward, w);
        const glm::dvec3 off = toward - closest * w;
        const double b2 = glm::dot(off, off);
        if (b2 >= shade.reach * shade.reach || closest - shade.reach > distance) continue;
        if (!shaped_.empty()) {
            const ShapedBlob& shaped = shaped_[listed_[j]];
            const BlobOnLine on = onLine(shaped.blob, &shaped.axes, position_, w);
            sum += on.half_line * std::exp(-on.k * on.k * on.b2) *
                   (table_.erf(on.k * (distance - on.closest)) + table_.erf(on.k * on.closest));
            continue;
        }
        sum += shade.half_line * std::exp(-shade.k * shade.k * b2) *
               (table_.erf(shade.k * (distance - closest)) + table_.erf(shade.k * closest));
    }
    return sum;
}

} // namespace brume::reference
