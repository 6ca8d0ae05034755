#include "server/effects/propagation/cell_matter.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shaders/shared/emission.h"

namespace brume {
namespace {

constexpr float kDeviationOfScale = 0.1f; // a particle's standard deviation is this part of scale * falloff
constexpr float kReach = 3;               // standard deviations, beyond which it counts for nothing
constexpr uint32_t kMostCells = 64;       // along a side

// Cells along one axis that a particle is in, and its parts there.
struct Along {
    uint32_t first = 0, end = 0;
    std::array<float, kMostCells> part; // NOLINT(cppcoreguidelines-pro-type-member-init): between first and end

    // `at`, `deviation`: in cells.
    Along(float at, float deviation, uint32_t side) {
        const float last = float(side - 1), reach = kReach * deviation;
        first = uint32_t(std::clamp(std::ceil(at - 0.5f - reach), 0.0f, last));
        end = uint32_t(std::clamp(std::floor(at - 0.5f + reach), 0.0f, last)) + 1;
        const float bend = -0.5f / (deviation * deviation);
        for (uint32_t i = first; i < end; ++i) {
            const float off = float(i) + 0.5f - at;
            part[i] = std::exp(bend * off * off);
        }
    }
};

void add(CellSum& sum, const CellMatter& matter, float extinction) {
    sum.times_extinction.albedo += extinction * matter.albedo;
    sum.times_extinction.emission += extinction * matter.emission;
    sum.extinction += extinction;
}

CellMatter meanOf(const CellSum& sum) {
    return {sum.times_extinction.albedo / sum.extinction, sum.times_extinction.emission / sum.extinction};
}

} // namespace

void cellMatter(const gpu::Tick& tick, std::span<const gpu::Particle> particles, uint32_t side,
                std::vector<CellSum>& sums, std::span<CellMatter> out) {
    sums.assign(size_t(side) * side * side, {});
    CellSum all;
    const glm::vec3 size = tick.map.hi - tick.map.lo, per_metre = float(side) / size;
    for (const gpu::Particle& p : particles) {
        const float deviation = kDeviationOfScale * p.scale * tick.falloff;
        const CellMatter matter{p.albedo, physics::emitted<float>(tick.emission, tick.cold_albedo, 1, p.albedo)};
        add(all, matter, p.sigma_t * deviation * deviation * deviation);
        const glm::vec3 deviations = glm::max(deviation * per_metre, 0.5f);
        const Along x((glm::dot(tick.map.x, p.centre) - tick.map.lo.x) * per_metre.x, deviations.x, side),
            y((glm::dot(tick.map.y, p.centre) - tick.map.lo.y) * per_metre.y, deviations.y, side),
            z((tick.map.hi.z - glm::dot(tick.sun.to_light, p.centre)) * per_metre.z, deviations.z, side);
        for (uint32_t k = z.first; k < z.end; ++k)
            for (uint32_t j = y.first; j < y.end; ++j) {
                const float of_row = p.sigma_t * z.part[k] * y.part[j];
                CellSum* const row = &sums[(size_t(k) * side + j) * side];
                for (uint32_t i = x.first; i < x.end; ++i) add(row[i], matter, of_row * x.part[i]);
            }
    }
    const CellMatter mean = all.extinction > 0 ? meanOf(all) : CellMatter{};
    std::ranges::transform(sums, out.begin(),
                           [&](const CellSum& sum) { return sum.extinction > 0 ? meanOf(sum) : mean; });
}

} // namespace brume
