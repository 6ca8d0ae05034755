#include "common/redraw.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/gtc/quaternion.hpp>

#include "shaders/shared/depth_layers.h"

namespace brume {
namespace {

constexpr float kInfinite = std::numeric_limits<float>::infinity();
// Transmittance of all layers below which what is behind them is not told from the picture.
constexpr float kLeastSeen = 0.3f;
// The level of means, over squares of 2^3 pixels, from which what is behind the layers is taken: smooth, without
// detail.
constexpr size_t kSmooth = 3;
// Weight of a mean over its squared transmittance. What is left of 1 goes to wider means.
constexpr float kTold = 2;
constexpr float kLeastLight = 1e-4f;  // exposed light of all layers below which they get no details
constexpr uint32_t kSteps = 2;        // steps by which a ray finds where it meets a layer
constexpr float kSurfaceStep = 1;     // pixels between places where a ray is compared with surfaces
constexpr uint32_t kMostSurface = 64; // places of a ray that are compared, at most
constexpr float kSameSide = 0.9f;     // part of a surface's depth: one nearer than that is another surface
constexpr float kSameSurface = 0.05f; // most difference of depths of one surface, as a part of them

// Inverse of what a display shows: sRGB byte -> exposed linear light.
float linearOf(float srgb, bool filmic) {
    const float x = srgb <= 0.04045f ? srgb / 12.92f : std::pow((srgb + 0.055f) / 1.055f, 2.4f);
    if (!filmic) return x;
    // y = x (2.51 x + 0.03) / (x (2.43 x + 0.59) + 0.14)
    const float y = std::min(x, 0.999f), a = 2.51f - 2.43f * y, b = 0.03f - 0.59f * y, c = -0.14f * y;
    return (-b + std::sqrt(std::max(b * b - 4 * a * c, 0.0f))) / (2 * a);
}

std::vector<float> curve(bool filmic) {
    std::vector<float> of(256);
    for (size_t i = 0; i < of.size(); ++i) of[i] = linearOf(float(i) / 255, filmic);
    return of;
}

// Weights of four neighbours at `t` between the middle two: a cubic B-spline.
glm::vec4 cubic(float t) {
    const float u = 1 - t;
    return glm::vec4(u * u * u, 4 + 3 * t * t * (t - 2), 4 + 3 * u * u * (u - 2), t * t * t) / 6.0f;
}

// A row-wise list with clamped places.
template <class T>
const T& clamped(const std::vector<T>& of, uint32_t width, uint32_t height, int x, int y) {
    return of[size_t(std::clamp(y, 0, int(height) - 1)) * width + size_t(std::clamp(x, 0, int(width) - 1))];
}

// Between pixels, whose middles are at halves.
template <class T>
T linear(const std::vector<T>& of, uint32_t width, uint32_t height, glm::vec2 pixel) {
    const glm::vec2 at = glm::clamp(pixel, glm::vec2(0), glm::vec2(width, height)) - 0.5f, low = glm::floor(at);
    const glm::vec2 t = at - low;
    const int x = int(low.x), y = int(low.y);
    return (1 - t.y) * ((1 - t.x) * clamped(of, width, height, x, y) + t.x * clamped(of, width, height, x + 1, y)) +
           t.y * ((1 - t.x) * clamped(of, width, height, x, y + 1) + t.x * clamped(of, width, height, x + 1, y + 1));
}

} // namespace

std::vector<glm::vec3> seenThrough(std::span<const glm::vec3> rest, std::span<const glm::vec4> layers, uint32_t width,
                                   uint32_t height, size_t smooth) {
    // Means over squares of 1, 2, 4 ... pixels: rest * transmittance, and its square.
    struct Level {
        uint32_t width, height;
        std::vector<glm::vec4> of;
    };
    std::vector<Level> levels{{width, height, {}}};
    for (size_t i = 0; i < rest.size(); ++i)
        levels[0].of.emplace_back(rest[i] * layers[i].a, layers[i].a * layers[i].a);
    while (levels.back().width > 1 || levels.back().height > 1) {
        const Level& fine = levels.back();
        Level coarse{(fine.width + 1) / 2, (fine.height + 1) / 2, {}};
        for (uint32_t y = 0; y < coarse.height; ++y)
            for (uint32_t x = 0; x < coarse.width; ++x) {
                glm::vec4 sum(0);
                for (int n = 0; n < 4; ++n)
                    sum += clamped(fine.of, fine.width, fine.height, int(2 * x) + n % 2, int(2 * y) + n / 2);
                coarse.of.push_back(0.25f * sum);
            }
        levels.push_back(std::move(coarse));
    }
    std::vector<glm::vec3> out(rest.size());
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            float left = 1; // weight that no mean has yet
            glm::vec3& own = out[size_t(y) * width + x];
            for (size_t level = std::min(smooth, levels.size() - 1); level < levels.size() && left > 1e-3f; ++level) {
                const Level& of = levels[level];
                const glm::vec4 mean =
                    linear(of.of, of.width, of.height, (glm::vec2(x, y) + 0.5f) / float(1u << level));
                const float part = level + 1 == levels.size() ? left : left * std::min(kTold * mean.a, 1.0f);
                own += part * glm::vec3(mean) / std::max(mean.a, 1e-6f);
                left -= part;
            }
        }
    return out;
}

Redraw::Redraw(const LayeredPicture& p)
    : made_{p.eye.position, glm::mat3_cast(p.eye.orientation), frustumOf(p.eye, p.width, p.height)}, width_(p.width),
      height_(p.height), count_(p.count), columns_(p.columns), rows_(p.rows), spacing_(p.spacing), first_(p.first),
      exposure_(p.exposure) {
    const std::vector<float> light = curve(p.filmic);
    const auto lightOf = [&](glm::u8vec3 c) { return glm::vec3(light[c.r], light[c.g], light[c.b]); };
    const size_t pixels = size_t(width_) * height_, nodes = size_t(columns_) * rows_;
    std::vector<glm::vec4> attenuated(pixels, glm::vec4(0, 0, 0, 1)); // light and transmittance of all layers so far
    for (uint32_t k = 0; k < count_; ++k) {
        std::vector<glm::vec4> at(nodes);
        std::vector<float>& depth = depths_.emplace_back(nodes);
        for (size_t n = 0; n < nodes; ++n) {
            at[n] = glm::vec4(lightOf(p.colours[k * nodes + n]), float(p.transmittance[k * nodes + n]) / 255);
            depth[n] = p.near * std::pow(p.far / p.near, float(p.depth[k * nodes + n]) / 255);
        }
        std::vector<glm::vec4>& layer = layers_.emplace_back(everywhere(at));
        for (size_t i = 0; i < pixels; ++i) {
            glm::vec4 &own = layer[i], &before = attenuated[i];
            own = glm::vec4(glm::max(glm::vec3(own), 0.0f), std::clamp(own.a, 0.0f, 1.0f));
            before = glm::vec4(glm::vec3(before) + before.a * glm::vec3(own), before.a * own.a);
        }
    }
    std::vector<glm::vec3> rest(pixels); // light of the picture without theirs
    for (size_t i = 0; i < pixels; ++i) rest[i] = lightOf(p.picture[i]) - glm::vec3(attenuated[i]);
    if (p.surface.empty() && count_ > 0) {
        std::vector<glm::vec4> sky(nodes);
        for (size_t n = 0; n < nodes; ++n) sky[n] = glm::vec4(lightOf(p.colours[count_ * nodes + n]), 0);
        for (const glm::vec4& one : everywhere(sky)) behind_.emplace_back(one);
    } else {
        behind_ = seenThrough(rest, attenuated, width_, height_, kSmooth);
    }
    const bool is_sky = p.surface.empty() && count_ > 0;
    for (size_t i = 0; i < pixels; ++i) {
        const glm::vec3 own(attenuated[i]), seen = attenuated[i].a * behind_[i];
        // What the picture shows besides, its details, belong to what is bright enough to have them.
        const glm::vec3 left = rest[i] - seen;
        const glm::vec3 part = is_sky ? glm::vec3(1) : own / glm::max(own + glm::max(seen, 0.0f), kLeastLight);
        const glm::vec3 factor = glm::clamp(1.0f + part * left / glm::max(own, kLeastLight), 0.25f, 4.0f);
        for (std::vector<glm::vec4>& layer : layers_) layer[i] *= glm::vec4(factor, 1);
        behind_[i] += (left - (factor - 1.0f) * own) / std::max(attenuated[i].a, kLeastSeen);
    }
    if (p.surface.empty()) return;
    surface_.resize(pixels);
    nearest_ = kInfinite;
    for (size_t i = 0; i < pixels; ++i) {
        surface_[i] = p.surface[i] == gpu::kSkyByte ? kInfinite : gpu::surfaceDepth(p.surface[i]);
        nearest_ = std::min(nearest_, surface_[i]);
    }
}

// Values at nodes, interpolated at all pixels: by a cubic B-spline through them, with the taps of slab_spline.comp.
std::vector<glm::vec4> Redraw::everywhere(const std::vector<glm::vec4>& nodes) const {
    constexpr float kInverse[3] = {1.59096f, -0.33987f, 0.04439f}; // by the distance from the middle
    std::vector<glm::vec4> coefficients(nodes.size()), out(size_t(width_) * height_);
    for (uint32_t y = 0; y < rows_; ++y)
        for (uint32_t x = 0; x < columns_; ++x)
            for (int n = 0; n < 25; ++n) {
                const int i = n % 5 - 2, j = n / 5 - 2;
                coefficients[size_t(y) * columns_ + x] += kInverse[std::abs(i)] * kInverse[std::abs(j)] *
                                                          clamped(nodes, columns_, rows_, int(x) + i, int(y) + j);
            }
    for (uint32_t y = 0; y < height_; ++y)
        for (uint32_t x = 0; x < width_; ++x) {
            const glm::vec2 node = (glm::vec2(x, y) + 0.5f - first_) / spacing_, low = glm::floor(node);
            const glm::vec4 across = cubic(node.x - low.x), down = cubic(node.y - low.y);
            for (int n = 0; n < 16; ++n)
                out[size_t(y) * width_ + x] +=
                    across[n % 4] * down[n / 4] *
                    clamped(coefficients, columns_, rows_, int(low.x) + n % 4 - 1, int(low.y) + n / 4 - 1);
        }
    return out;
}

glm::vec2 Redraw::pixelOf(glm::vec3 seen) const {
    const Frustum& f = made_.frustum;
    return {(f.left + seen.x / seen.z) / (f.left + f.right) * float(width_),
            (f.up - seen.y / seen.z) / (f.up + f.down) * float(height_)};
}

float Redraw::depthAt(uint32_t layer, glm::vec2 pixel) const {
    const glm::vec2 node = (pixel - first_) / spacing_ + 0.5f;
    return linear(depths_[layer], columns_, rows_, node);
}

float Redraw::surfaceAt(glm::vec2 pixel) const {
    if (surface_.empty()) return kInfinite;
    return clamped(surface_, width_, height_, int(std::floor(std::clamp(pixel.x, -1.0f, float(width_)))),
                   int(std::floor(std::clamp(pixel.y, -1.0f, float(height_)))));
}

// `from`, `dir`: a ray in the picture's own view: right, up and depth. `depth`: where it meets the layer.
glm::vec2 Redraw::meet(uint32_t layer, glm::vec3 from, glm::vec3 dir, float& depth) const {
    glm::vec2 at = pixelOf(dir);
    for (uint32_t i = 0; i < kSteps; ++i) {
        depth = depthAt(layer, at);
        at = pixelOf(from + dir * ((depth - from.z) / dir.z));
    }
    return at;
}

// The nearest surface on the ray. One that goes on behind what is nearer may meet another there. If it meets none, what
// lies beside the nearer one is continued.
glm::vec2 Redraw::meetSurface(glm::vec3 from, glm::vec3 dir, float& depth) const {
    const glm::vec2 distant = pixelOf(dir);
    depth = kInfinite;
    if (surface_.empty() || !(nearest_ < kInfinite)) return distant;
    const auto at = [&](float inverse) { return pixelOf(from * inverse + dir * ((1 - from.z * inverse) / dir.z)); };
    const float most = 1 / nearest_;
    const auto steps = uint32_t(std::clamp(glm::distance(at(most), distant) / kSurfaceStep, 1.0f, float(kMostSurface)));
    float before = most;
    bool was_front = true;
    glm::vec2 beside = distant;
    for (uint32_t i = 1; i <= steps; ++i) {
        const float now = most * float(steps - i) / float(steps);
        const bool front = now * surfaceAt(at(now)) > 1;
        if (!front && was_front) {
            float near = before, far = now; // inverse depths, before and behind a surface
            for (uint32_t k = 0; k < 5; ++k) {
                const float middle = 0.5f * (near + far);
                (middle * surfaceAt(at(middle)) > 1 ? near : far) = middle;
            }
            const glm::vec2 there = at(far);
            const float found = surfaceAt(there);
            if (std::abs(found * far - 1) < kSameSurface || i == steps) {
                depth = found;
                return there;
            }
            beside = glm::floor(at(near)) + 0.5f; // not mixed with the nearer one
        }
        was_front = front;
        before = now;
    }
    if (!was_front) depth = surfaceAt(beside);
    return beside;
}

void Redraw::draw(const Pose& eye, uint32_t width, uint32_t height, std::span<glm::vec3> out) const {
    const glm::mat3 into = glm::transpose(made_.axes), axes = glm::mat3_cast(eye.orientation);
    const Frustum f = frustumOf(eye, width, height);
    const auto seen = [&](glm::vec3 world) { // in the picture's own view, with depth in place of back
        const glm::vec3 v = into * world;
        return glm::vec3(v.x, v.y, -v.z);
    };
    const glm::vec3 from = seen(eye.position - made_.position);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const float right = -f.left + (f.left + f.right) * (float(x) + 0.5f) / float(width);
            const float up = f.up - (f.up + f.down) * (float(y) + 0.5f) / float(height);
            const glm::vec3 dir = seen(axes * glm::vec3(right, up, -1));
            glm::vec3& pixel = out[size_t(y) * width + x];
            pixel = glm::vec3(0);
            if (dir.z <= 1e-3f) continue; // beside or behind all that the picture shows
            float surface = 0, through = 1;
            const glm::vec2 behind = meetSurface(from, dir, surface);
            for (uint32_t k = 0; k < count_; ++k) {
                float depth = 0;
                const glm::vec2 at = meet(k, from, dir, depth);
                if (depth > surface && surface < kSameSide * surfaceAt(at)) continue; // hidden by what was beside it
                const glm::vec4 layer = linear(layers_[k], width_, height_, at);
                pixel += through * glm::vec3(layer);
                through *= layer.a;
            }
            pixel = (pixel + through * linear(behind_, width_, height_, behind)) / exposure_;
        }
}

} // namespace brume
