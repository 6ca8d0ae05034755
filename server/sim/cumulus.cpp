// A cumulus: billows on billows (a fractal of spheres over a flat base), filled so that the inside is evenly dense and
// the detail sits at the surface. A particle's size follows its depth below the surface, and the number of particles
// the inverse volume of their size.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/random.h"
#include "server/sim/layout.h"

namespace brume {

namespace {

// Lengths in this part are fractions of a width that is about 1; the result is fitted to the medium's extent.
struct Billow {
    glm::vec3 centre;
    float radius;
};

constexpr int kLevels = 4;
constexpr std::array<int, kLevels - 1> kChildren{9, 8, 6};
constexpr std::array<Range, kLevels - 1> kRatio{
    {{0.32f, 0.58f}, {0.34f, 0.56f}, {0.36f, 0.56f}}}; // child's radius to its parent's

// A wide row of low billows, and a few heaps that tower over its middle.
std::vector<Billow> heaps(Random& random) {
    std::vector<Billow> out;
    for (int i = 0; i < 9; ++i) {
        const glm::vec2 at = random.inDisc();
        const float edge = std::sqrt(glm::dot(at, at)), radius = random.uniform(0.9f, 1.2f) * (0.17f - 0.09f * edge);
        out.push_back({{0.36f * at.x, radius * random.uniform(0.2f, 0.6f), 0.24f * at.y}, radius});
    }
    for (int i = 0; i < 4; ++i) {
        const glm::vec2 at = random.inDisc();
        const float height = 0.13f + 0.075f * static_cast<float>(i);
        out.push_back({{0.03f + 0.16f * at.x, height, 0.09f * at.y},
                       random.uniform(0.9f, 1.1f) * (0.17f - 0.02f * static_cast<float>(i))});
    }
    return out;
}

// Below the surface of the union; negative outside.
float depthIn(const std::vector<Billow>& billows, glm::vec3 place) {
    float depth = -1;
    for (const Billow& b : billows) depth = std::max(depth, b.radius - glm::distance(place, b.centre));
    return depth;
}

std::vector<Billow> grow(Random& random) {
    std::vector<Billow> all = heaps(random), parents = all;
    for (int level = 0; level + 1 < kLevels; ++level) {
        const auto l = static_cast<size_t>(level);
        std::vector<Billow> children;
        for (const Billow& parent : parents) {
            for (int i = 0; i < kChildren[l]; ++i) {
                glm::vec3 direction = random.direction();
                if (direction.y < -0.3f) direction.y = -direction.y; // rising air bulges upward
                const float radius = parent.radius * random.uniform(kRatio[l].lo, kRatio[l].hi);
                const glm::vec3 centre = parent.centre + direction * (parent.radius * 0.95f);
                if (centre.y < 0 || depthIn(parents, centre) > 0.6f * radius)
                    continue; // under the base, or buried in a neighbour
                children.push_back({centre, radius});
            }
        }
        all.insert(all.end(), children.begin(), children.end());
        parents = std::move(children);
    }
    return all;
}

// Depth below the surface on a cube of cells in Morton order, so that neighbours in the list are neighbours in space.
class DepthGrid {
public:
    static constexpr int kBits = 7, kSide = 1 << kBits;

    DepthGrid(const std::vector<Billow>& billows, glm::vec3 lowest, float cell)
        : lowest_(lowest), cell_(cell), depth_(size_t{1} << (3 * kBits), -1.0f) {
        for (const Billow& b : billows) {
            const glm::ivec3 from =
                glm::max(glm::ivec3(glm::floor((b.centre - b.radius - lowest) / cell)), glm::ivec3(0));
            const glm::ivec3 to =
                glm::min(glm::ivec3(glm::floor((b.centre + b.radius - lowest) / cell)), glm::ivec3(kSide - 1));
            for (int z = from.z; z <= to.z; ++z)
                for (int y = from.y; y <= to.y; ++y)
                    for (int x = from.x; x <= to.x; ++x) {
                        const glm::vec3 place = lowest + (glm::vec3(x, y, z) + 0.5f) * cell;
                        const float depth =
                            std::min(b.radius - glm::distance(place, b.centre), place.y); // the base is at y = 0
                        float& stored = depth_[morton(x, y, z)];
                        stored = std::max(stored, depth);
                    }
        }
    }

    size_t cells() const { return depth_.size(); }
    float depth(size_t cell) const { return depth_[cell]; }
    glm::vec3 placeIn(size_t cell, glm::vec3 inside) const { // inside in [0, 1)^3
        return lowest_ + (glm::vec3(gathered(cell), gathered(cell >> 1), gathered(cell >> 2)) + inside) * cell_;
    }

private:
    static size_t spread(int value) {
        size_t out = 0;
        for (int bit = 0; bit < kBits; ++bit) out |= static_cast<size_t>((value >> bit) & 1) << (3 * bit);
        return out;
    }
    static int gathered(size_t cell) {
        int out = 0;
        for (int bit = 0; bit < kBits; ++bit) out |= static_cast<int>((cell >> (3 * bit)) & 1) << bit;
        return out;
    }
    static size_t morton(int x, int y, int z) { return spread(x) | spread(y) << 1 | spread(z) << 2; }

    glm::vec3 lowest_;
    float cell_;
    std::vector<float> depth_;
};

} // namespace

Placement cumulus(const Medium& medium) {
    Random random(medium.seed);
    std::vector<Billow> billows = grow(random);
    glm::vec3 lo(1e9f), hi(-1e9f);
    for (const Billow& b : billows) {
        lo = glm::min(lo, b.centre - b.radius);
        hi = glm::max(hi, b.centre + b.radius);
    }
    const float fit = medium.extent / (hi.x - lo.x), side = std::max({hi.x - lo.x, hi.y, hi.z - lo.z}) * fit;
    const glm::vec3 middle(0.5f * (lo.x + hi.x), 0, 0.5f * (lo.z + hi.z));
    for (Billow& b : billows) b = {(b.centre - middle) * fit, b.radius * fit};
    const DepthGrid grid(billows, {-0.5f * side, 0, -0.5f * side}, side / DepthGrid::kSide);

    // A Gaussian reaches about two standard deviations of scale * falloff / 10: as far as its depth.
    const auto scaleAt = [&](float depth) {
        return std::clamp(5 * depth / medium.falloff, medium.scale.lo, medium.scale.hi);
    };
    std::vector<double> sum(grid.cells() + 1, 0); // of the numbers of particles per cell, relative
    for (size_t c = 0; c < grid.cells(); ++c) {
        const double scale = scaleAt(grid.depth(c));
        sum[c + 1] = sum[c] + (grid.depth(c) > 0 ? 1 / (scale * scale * scale) : 0);
    }

    Placement out;
    size_t cell = 0;
    for (uint32_t i = 0; i < medium.count; ++i) { // one in each of `count` equal shares: neither clumps nor gaps
        const double share = (i + static_cast<double>(random.uniform())) / medium.count * sum.back();
        while (cell + 1 < grid.cells() && sum[cell + 1] <= share) ++cell;
        const glm::vec3 inside = 0.5f + 0.5f * random.inBox();
        out.position.push_back(grid.placeIn(cell, inside));
        out.scale.push_back(scaleAt(grid.depth(cell)));
    }
    return out;
}

} // namespace brume
