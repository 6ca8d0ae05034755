// DensityGrid: extinction of Gaussian particles and of a union of balls at a point, and its upper bounds in cells
// along a ray.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "tools/reference/geometry.h"
#include "tools/reference/world.h"

namespace brume::reference {

class DensityGrid {
public:
    // `world` must outlive it. Gaussians end at kReach / k: a part of 1e-9 is left out.
    explicit DensityGrid(const World& world);

    struct Density {
        double extinction = 0;    // 1/m
        glm::dvec3 scattering{0}; // sum of albedo * extinction
    };
    // The medium at x. Precondition: x is in this cell.
    Density at(size_t cell, glm::dvec3 x) const;

    // Calls visit(cell, t0, t1, majorant) for each cell on [ray.begin, ray.end], in order, while it returns true; the
    // extinction in the cell is at most `majorant`. (Amanatides and Woo 1987.)
    template <typename Visit>
    void walk(const Ray& ray, const Visit& visit) const {
        Interval part{ray.begin, ray.end};
        for (int i = 0; i < 3; ++i) {
            const double a = (lo_[i] - ray.origin[i]) / ray.direction[i],
                         b = (hi_[i] - ray.origin[i]) / ray.direction[i];
            if (ray.direction[i] != 0)
                part = common(part, {std::min(a, b), std::max(a, b)});
            else if (!(ray.origin[i] >= lo_[i] && ray.origin[i] <= hi_[i]))
                return;
        }
        if (part.empty()) return;
        const glm::dvec3 from = (ray.at(part.begin) - lo_) / cell_;
        glm::ivec3 at = glm::clamp(glm::ivec3(glm::floor(from)), glm::ivec3(0), count_ - 1);
        double t = part.begin;
        while (t < part.end) {
            int axis = 0;
            double leave = kInfinity;
            for (int i = 0; i < 3; ++i) {
                if (ray.direction[i] == 0) continue;
                const double border = lo_[i] + (at[i] + (ray.direction[i] > 0 ? 1 : 0)) * cell_;
                if (const double next = (border - ray.origin[i]) / ray.direction[i]; next < leave)
                    leave = next, axis = i;
            }
            const size_t cell = (static_cast<size_t>(at.z) * count_.y + at.y) * count_.x + at.x;
            const double t1 = std::min(std::max(leave, t), part.end);
            if (majorants_[cell] > 0 && t1 > t && !visit(cell, t, t1, majorants_[cell])) return;
            t = t1;
            at[axis] += ray.direction[axis] > 0 ? 1 : -1;
            if (at[axis] < 0 || at[axis] >= count_[axis]) return;
        }
    }

private:
    const World& world_;
    glm::dvec3 lo_{0}, hi_{0};
    glm::ivec3 count_{0};
    double cell_ = 1; // m
    std::vector<double> majorants_;
    std::vector<std::vector<uint32_t>> blobs_, balls_; // per cell: the particles and balls that reach it
};

} // namespace brume::reference
