#include "tools/reference/density_grid.h"

#include <algorithm>

#include "shaders/shared/ellipsoid.h"
#include "tools/reference/light_field.h"

namespace brume::reference {

DensityGrid::DensityGrid(const World& world) : world_(world) {
    const auto& balls = world.balls.balls;
    if (world.blobs.empty() && balls.empty()) return;
    lo_ = glm::dvec3(kInfinity);
    hi_ = glm::dvec3(-kInfinity);
    double size = 0;
    const auto hold = [&](glm::dvec3 centre, double radius, double feature) {
        lo_ = glm::min(lo_, centre - radius);
        hi_ = glm::max(hi_, centre + radius);
        size += feature;
    };
    for (const Blob& b : world.blobs) hold(b.centre, kReach / b.k, 1 / b.k);
    for (const UnionMedium::Ball& b : balls) hold(b.centre, b.radius, b.radius);
    // Cells of a typical 1/k: bounds within a factor of about 2 of what is there. At most 96 a side.
    const glm::dvec3 extent = hi_ - lo_;
    cell_ = std::max(size / static_cast<double>(world.blobs.size() + balls.size()),
                     std::max({extent.x, extent.y, extent.z}) / 96);
    count_ = glm::ivec3(extent / cell_) + 1;
    hi_ = lo_ + cell_ * glm::dvec3(count_);
    const size_t cells = static_cast<size_t>(count_.x) * count_.y * count_.z;
    majorants_.resize(cells);
    blobs_.resize(cells);
    balls_.resize(cells);

    // Calls visit(cell, squared distance of the cell's nearest point) for the cells within `radius` of the centre.
    const auto around = [&](glm::dvec3 centre, double radius, const auto& visit) {
        const glm::ivec3 first = glm::clamp(glm::ivec3((centre - radius - lo_) / cell_), glm::ivec3(0), count_ - 1);
        const glm::ivec3 last = glm::clamp(glm::ivec3((centre + radius - lo_) / cell_), glm::ivec3(0), count_ - 1);
        for (int z = first.z; z <= last.z; ++z)
            for (int y = first.y; y <= last.y; ++y)
                for (int x = first.x; x <= last.x; ++x) {
                    const glm::dvec3 corner = lo_ + cell_ * glm::dvec3(x, y, z);
                    const glm::dvec3 off = glm::clamp(centre, corner, corner + cell_) - centre;
                    const double squared = glm::dot(off, off);
                    if (squared < radius * radius)
                        visit((static_cast<size_t>(z) * count_.y + y) * count_.x + x, squared);
                }
    };
    for (uint32_t i = 0; i < world.blobs.size(); ++i) {
        const Blob& b = world.blobs[i];
        around(b.centre, kReach / b.k, [&](size_t cell, double squared) {
            blobs_[cell].push_back(i);
            majorants_[cell] += b.sigma_t * std::exp(-b.k * b.k * squared);
        });
    }
    for (uint32_t i = 0; i < balls.size(); ++i)
        around(balls[i].centre, balls[i].radius, [&](size_t cell, double) {
            if (balls_[cell].empty()) majorants_[cell] += world.balls.sigma_t;
            balls_[cell].push_back(i);
        });
    for (double& majorant : majorants_) majorant *= 1 + 1e-9; // a point on a cell's border may round to either side
}

DensityGrid::Density DensityGrid::at(size_t cell, glm::dvec3 x) const {
    Density density;
    for (const uint32_t i : blobs_[cell]) {
        const Blob& b = world_.blobs[i];
        const glm::dvec3 off = x - b.centre;
        const SemiAxes* const axes = axesOf(world_, i);
        const glm::dvec3 in = axes ? physics::inSemiAxes(off, axes->a, axes->b, axes->c) : off;
        const double sigma = b.sigma_t * std::exp(-b.k * b.k * glm::dot(in, in));
        density.extinction += sigma;
        density.scattering += sigma * b.albedo;
    }
    for (const uint32_t i : balls_[cell]) {
        const glm::dvec3 off = x - world_.balls.balls[i].centre;
        if (glm::dot(off, off) >= world_.balls.balls[i].radius * world_.balls.balls[i].radius) continue;
        density.extinction += world_.balls.sigma_t;
        density.scattering += world_.balls.sigma_t * world_.balls.albedo;
        break; // however many balls there are
    }
    return density;
}

} // namespace brume::reference
