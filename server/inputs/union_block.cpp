#include "server/inputs/union_block.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace brume {
namespace {

constexpr double kMostCells = 64; // along a side

uint32_t surfacesOf(const PathSettings& path) {
    return path.surfaces == "nearest"  ? gpu::kUnionNearest
           : path.surfaces == "binary" ? gpu::kUnionBinary
           : path.surfaces == "none"   ? gpu::kUnionNone
                                       : gpu::kUnionExact;
}

} // namespace

void setBalls(gpu::Tick& tick, const Medium& medium, const RenderSettings& render,
              std::span<const gpu::Particle> particles) {
    gpu::UnionBalls& balls = tick.balls;
    balls = {.radius = medium.union_radius,
             .sigma_t = medium.union_extinction,
             .cell = 1,
             .cutoff = render.path.cutoff,
             .surfaces = surfacesOf(render.path)};
    if (particles.empty()) return;
    glm::vec2 lo(std::numeric_limits<float>::max()), hi(std::numeric_limits<float>::lowest());
    for (const gpu::Particle& p : particles) {
        const glm::vec2 at(glm::dot(tick.map.x, p.centre), glm::dot(tick.map.y, p.centre));
        lo = glm::min(lo, at - balls.radius * p.scale);
        hi = glm::max(hi, at + balls.radius * p.scale);
    }
    balls.side = uint32_t(std::clamp(0.6 * std::sqrt(double(particles.size())), 1.0, kMostCells));
    balls.words = uint32_t((particles.size() + 31) / 32);
    balls.lo = lo;
    balls.cell = 1.001f * std::max(std::max(hi.x - lo.x, hi.y - lo.y), 1e-6f) / float(balls.side);
}

} // namespace brume
