#include "server/methods/sprites/puffs.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/random.h"

namespace brume::methods::sprites {
namespace {

constexpr uint32_t kSide = 48, kFrames = 16, kLumps = 28; // texels, frames, Gaussians of a puff
constexpr float kPuffDepth = 2.5f;                        // optical depth of a puff's middle, for its light alone

// The depths of a frame's texels over their mean.
void normalise(std::vector<glm::vec4>& positive, size_t first, size_t count) {
    double sum = 0;
    for (size_t i = first; i < first + count; ++i) sum += double(positive[i].w);
    for (size_t i = first; i < first + count; ++i) positive[i].w *= float(double(count) / std::max(sum, 1e-9));
}

// Extinction at the middles of kSide^3 cells of [-1, 1]^3: [z][y][x], x to the right, y up, z toward the viewer.
class Puff {
public:
    explicit Puff(uint32_t frame) : extinction_(size_t(kSide) * kSide * kSide) {
        Random random(77, frame);
        for (uint32_t lump = 0; lump < kLumps; ++lump) {
            const glm::vec3 at = 0.62f * random.inBall();
            const float width = random.uniform(0.11f, 0.26f) * (1.2f - 0.5f * glm::length(at)),
                        k = 0.5f / (width * width);
            std::array<std::array<float, kSide>, 3> along{}; // a Gaussian is the product of three of one coordinate
            for (uint32_t i = 0; i < kSide; ++i)
                for (int c = 0; c < 3; ++c) along[c][i] = std::exp(-k * (place(i) - at[c]) * (place(i) - at[c]));
            for (uint32_t z = 0; z < kSide; ++z)
                for (uint32_t y = 0; y < kSide; ++y) {
                    const float yz = along[1][y] * along[2][z];
                    for (uint32_t x = 0; x < kSide; ++x) extinction_[index(x, y, z)] += yz * along[0][x];
                }
        }
        // No texel at the picture's border has any: lumps end within the unit ball.
        for (uint32_t z = 0; z < kSide; ++z)
            for (uint32_t y = 0; y < kSide; ++y)
                for (uint32_t x = 0; x < kSide; ++x) {
                    const float r = glm::length(glm::vec3(place(x), place(y), place(z)));
                    const float edge = std::clamp((0.98f - r) / 0.25f, 0.0f, 1.0f);
                    extinction_[index(x, y, z)] *= edge * edge * (3 - 2 * edge);
                }
        double sum = 0;
        for (const float one : extinction_) sum += double(one);
        const double mean = sum * kCell / (kSide * kSide); // depth of a line of sight, in the mean
        for (float& one : extinction_) one *= float(kPuffDepth / (2 * mean));
    }

    // Optical depth from the middle of every cell to the puff's end along an axis, toward its positive end or not.
    std::vector<float> depths(int axis, bool positive) const {
        std::vector<float> out(extinction_.size());
        const std::array<size_t, 3> steps{1, kSide, size_t(kSide) * kSide};
        const size_t step = steps[axis], u = steps[(axis + 1) % 3], v = steps[(axis + 2) % 3];
        for (size_t a = 0; a < kSide; ++a)
            for (size_t b = 0; b < kSide; ++b) {
                float depth = 0;
                for (size_t i = 0; i < kSide; ++i) {
                    const size_t at = a * u + b * v + (positive ? kSide - 1 - i : i) * step;
                    out[at] = depth + 0.5f * kCell * extinction_[at];
                    depth += kCell * extinction_[at];
                }
            }
        return out;
    }
    float extinction(uint32_t x, uint32_t y, uint32_t z) const { return extinction_[index(x, y, z)]; }

    static constexpr float kCell = 2.0f / float(kSide);
    static size_t index(uint32_t x, uint32_t y, uint32_t z) { return (size_t(z) * kSide + y) * kSide + x; }

private:
    static float place(uint32_t i) { return (float(i) + 0.5f) * kCell - 1; }

    std::vector<float> extinction_;
};

void bake(uint32_t frame, LightMaps& maps) {
    const Puff puff(frame);
    std::array<std::vector<float>, 6> toward; // right, top, front, left, bottom, back
    for (int axis = 0; axis < 3; ++axis)
        toward[axis] = puff.depths(axis, true), toward[axis + 3] = puff.depths(axis, false);
    const size_t first = size_t(frame) * kSide * kSide;
    std::array<double, 6> sums{};
    double opacities = 0;
    for (uint32_t row = 0; row < kSide; ++row)
        for (uint32_t x = 0; x < kSide; ++x) {
            std::array<float, 6> light{};
            float depth = 0;
            for (uint32_t i = 0; i < kSide; ++i) { // from the front to the back
                const size_t at = Puff::index(x, kSide - 1 - row, kSide - 1 - i);
                const float own = Puff::kCell * puff.extinction(x, kSide - 1 - row, kSide - 1 - i);
                const float seen = std::exp(-depth) * -std::expm1(-own);
                for (int way = 0; way < 6; ++way) light[way] += seen * std::exp(-toward[way][at]);
                depth += own;
            }
            const float opacity = -std::expm1(-depth);
            opacities += double(opacity);
            for (int way = 0; way < 6; ++way) sums[way] += double(light[way]);
            const float per = 1 / std::max(opacity, 1e-6f); // light per opacity: 1 in a puff without shadows
            maps.positive[first + size_t(row) * kSide + x] = {light[0] * per, light[1] * per, light[2] * per, depth};
            maps.negative[first + size_t(row) * kSide + x] = {light[3] * per, light[4] * per, light[5] * per, 0};
        }
    // Particles are dimmed by their own ball already: what is left is how light differs within a puff.
    for (size_t i = first; i < first + size_t(kSide) * kSide; ++i)
        for (int way = 0; way < 3; ++way) {
            maps.positive[i][way] *= float(opacities / sums[way]);
            maps.negative[i][way] *= float(opacities / sums[way + 3]);
        }
    normalise(maps.positive, first, size_t(kSide) * kSide);
}

} // namespace

const LightMaps& bakedMaps() {
    static const LightMaps kBaked = [] {
        LightMaps maps{kSide, kFrames, std::vector<glm::vec4>(size_t(kFrames) * kSide * kSide), {}};
        maps.negative = maps.positive;
        for (uint32_t frame = 0; frame < kFrames; ++frame) bake(frame, maps);
        return maps;
    }();
    return kBaked;
}

LightMaps evenMaps() {
    LightMaps maps{kSide, 1, std::vector<glm::vec4>(size_t(kSide) * kSide, glm::vec4(1)), {}};
    maps.negative = maps.positive;
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const glm::vec2 at = (glm::vec2(x, y) + 0.5f) * Puff::kCell - 1.0f;
            maps.positive[y * kSide + x].w = std::sqrt(std::max(1 - glm::dot(at, at), 0.0f));
        }
    normalise(maps.positive, 0, maps.positive.size());
    return maps;
}

} // namespace brume::methods::sprites
