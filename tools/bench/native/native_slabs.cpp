#include "tools/bench/native/native_slabs.h"

#include <algorithm>
#include <barrier>
#include <chrono>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <thread>

#include "server/inputs/eye_request.h"
#include "server/inputs/objects.h"
#include "server/inputs/tick_block.h"
#include "shaders/shared/erf.h"
#include "shaders/shared/sharpen.h"
#include "shaders/shared/support.h"
#include "shaders/shared/transmittance.h"
#include "shaders/shared/widened.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace brume::bench {
namespace {

using native::kMostLanes;
using native::kRays;
using native::kTile;
using Clock = std::chrono::steady_clock;

constexpr uint32_t kMargin = 3;                          // nodes before the first pixel's
constexpr float kLeastAcross = 0.7f, kLeastAlong = 0.7f; // as shaders/slab_bins.comp
constexpr float kMostSpread = 60;                        // log2 of a Gaussian along a run: a float32 has 126
constexpr uint32_t kMostRun = 16;                        // slabs, whose rounding errors add up quadratically
constexpr uint32_t kRowsAtOnce = 8;                      // of pixels, that a thread takes

uint32_t upTo(uint32_t count, uint32_t multiple) { return (count + multiple - 1) / multiple * multiple; }

double since(Clock::time_point begin) {
    return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

// Tiny numbers count as zero, as on the threads of CPU drivers: they would cost a hundred times the time.
void flushTiny() {
#if defined(__x86_64__)
    _mm_setcsr(_mm_getcsr() | 0x8040);
#endif
}

} // namespace

bool NativeSlabs::runs(const native::Kernel& kernel) {
    if (&kernel == &native::kPortable) return true;
#if defined(__x86_64__)
    if (&kernel == &native::kAvx512) return __builtin_cpu_supports("avx512f");
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#else
    return false;
#endif
}

const native::Kernel* NativeSlabs::named([[maybe_unused]] std::string_view name) {
#if defined(__x86_64__)
    for (const native::Kernel* kernel : {&native::kAvx512, &native::kAvx2})
        if ((name.empty() || name == kernel->name) && runs(*kernel)) return kernel;
#endif
    return nullptr;
}

NativeSlabs::NativeSlabs(const Stage& stage, glm::uvec2 size, uint32_t rate, uint32_t slabs,
                         const native::Kernel& kernel, uint32_t threads)
    : kernel_(kernel), threads_(threads), particles_(stage.particles()), pose_(stage.pose()), size_(size) {
    tick_ = makeTick(stage.scene(), stage.simulation().now(), particles_, opaqueObjects(stage.scene()));
    extent_ = mediumExtent(particles_, tick_.falloff, tick_.cut);
    if (tick_.opaque_count > 0 || tick_.phase.part > 0 || tick_.phase.second != 0 || tick_.ambient != glm::vec3(0) ||
        !extent_.one_albedo)
        throw std::runtime_error(stage.scene().name +
                                 ": the native slabs have no opaque objects, lobe, ambient light or colours");

    const glm::mat3 axes = glm::mat3_cast(pose_.orientation);
    float near = 1e30f, far = -1e30f; // view depths between which the medium lies
    for (int corner = 0; corner < 8; ++corner) {
        const glm::vec3 at(corner & 1 ? extent_.hi.x : extent_.lo.x, corner & 2 ? extent_.hi.y : extent_.lo.y,
                           corner & 4 ? extent_.hi.z : extent_.lo.z);
        const float depth = -glm::dot(at - pose_.position, axes[2]);
        near = std::min(near, depth), far = std::max(far, depth);
    }
    near = std::max(near, kNearDepth);
    if (far <= near) throw std::runtime_error(stage.scene().name + ": the medium is behind the camera");

    native::Frame& f = frame_;
    f.rate = rate, f.slabs = upTo(slabs, 8);
    f.depth = near, f.thickness = (far - near) / float(f.slabs);
    const float tan_y = std::tan(0.5f * pose_.fov_y), tan_x = tan_y * float(size.x) / float(size.y);
    const float pixel = 2 * tan_y / float(size.y);
    f.spacing = pixel * float(rate);
    const float before = float(kMargin * rate) - 0.5f; // pixels
    f.corner_x = -tan_x - before * pixel, f.corner_y = -tan_y - before * pixel;
    nodes_ = (size + rate - 1u) / rate + uint32_t(2 * kMargin + 1);
    tiles_ = (nodes_ + kTile - 1u) / kTile;
    nodes_.y = tiles_.y * kTile;
    f.nodes = upTo(tiles_.x * kTile, kMostLanes) + kMostLanes;
    f.width = upTo(size.x, kMostLanes);

    const auto inMap = [&](glm::vec3 x, float w) { // columns, rows and planes of the light's map
        const glm::vec4 h(x, w);
        return glm::vec3(glm::dot(tick_.map.u, h) * float(tick_.map.texels.x) - 0.5f * w,
                         glm::dot(tick_.map.v, h) * float(tick_.map.texels.y) - 0.5f * w, glm::dot(tick_.map.plane, h));
    };
    const glm::vec3 eye = inMap(pose_.position, 1),
                    ray = inMap(f.corner_x * axes[0] - f.corner_y * axes[1] - axes[2], 0);
    const glm::vec3 right = inMap(f.spacing * axes[0], 0), down = inMap(-f.spacing * axes[1], 0);
    for (int i = 0; i < 3; ++i) f.eye[i] = eye[i], f.ray[i] = ray[i], f.right[i] = right[i], f.down[i] = down[i];
    mapLight(particles_);
    const glm::vec3 colour = extent_.albedo * tick_.sun.irradiance * (0.25f / std::numbers::pi_v<float>);
    for (int i = 0; i < 3; ++i) f.colour[i] = colour[i];

    for (uint32_t x = 0; x < std::max(rate, kMostLanes); ++x) { // a cubic B-spline's
        const float t = float(x % rate) / float(rate), r = 1 - t;
        const float weights[4] = {r * r * r, (3 * t - 6) * t * t + 4, (3 * r - 6) * r * r + 4, t * t * t};
        for (int j = 0; j < 4; ++j) weights_[j].push_back(weights[j] / 6);
    }
    for (int j = 0; j < 4; ++j) {
        f.weights[j] = weights_[j].data();
        picture_[j].resize(size_t(f.width) * size.y);
        f.picture[j] = picture_[j].data();
    }
    for (int i = 0; i < 2; ++i) {
        field_[i].resize(size_t(tiles_.y) * kTile * f.nodes);
        f.field[i] = field_[i].data();
        spline_[i].resize(field_[i].size() + f.nodes);
        f.spline[i] = &spline_[i][(kMargin - 1) * (f.nodes + 1)]; // of the first pixel's cell
    }
    members_.resize(particles_.size());
    f.members = members_.data();
    lists_.assign(threads, std::vector<std::vector<uint32_t>>(size_t(tiles_.x) * tiles_.y));
    scratch_.assign(threads, std::vector<float>(std::max<size_t>(size_t(f.slabs) * kRays, 2 * size_t(f.nodes))));
}

// As shaders/shadow_particles.comp and shadow_volume.comp.
void NativeSlabs::mapLight(const std::vector<gpu::Particle>& particles) {
    const glm::uvec3 size(tick_.map.texels, tick_.map.slices);
    for (int axis = 0; axis < 3; ++axis) frame_.light_size[axis] = size[axis];
    light_.assign(size_t(size.x) * size.y * size.z, 0.0f);
    frame_.light = light_.data();
    const glm::vec3 cell = (tick_.map.hi - tick_.map.lo) / glm::vec3(size.x, size.y, size.z - 1);
    std::vector<float> columns(size.x), planes(size.z);
    for (const gpu::Particle& p : particles) {
        const float u = p.scale * tick_.falloff, k = physics::gaussianK(p.scale, tick_.falloff);
        const float radius = physics::supportRadius(p.sigma_t, u, 0.75f * tick_.cut);
        if (radius <= 0) continue;
        const glm::vec3 at = glm::vec3(glm::dot(tick_.map.x, p.centre) - tick_.map.lo.x,
                                       glm::dot(tick_.map.y, p.centre) - tick_.map.lo.y,
                                       tick_.map.hi.z - glm::dot(tick_.sun.to_light, p.centre)) /
                                 cell -
                             glm::vec3(0.5f, 0.5f, 0);
        const glm::vec3 variance = 0.5f / (k * cell * k * cell);
        const glm::vec3 stored(physics::sharpened(variance.x), physics::sharpened(variance.y),
                               physics::sharpened(variance.z));
        const glm::vec3 narrow = glm::inversesqrt(2.0f * stored);
        const float half =
            0.5f * physics::lineDepth(p.sigma_t, k, 1.0f) * std::sqrt(variance.x / stored.x * (variance.y / stored.y));
        const glm::ivec3 from = glm::max(glm::ivec3(glm::floor(at - radius / cell)), 0);
        const glm::ivec3 to = glm::min(glm::ivec3(glm::ceil(at + radius / cell)), glm::ivec3(size) - 1);
        for (int x = from.x; x <= to.x; ++x) columns[x] = std::exp(-std::pow(narrow.x * (float(x) - at.x), 2.0f));
        for (int z = from.z; z < int(size.z); ++z) planes[z] = half * physics::erfc(narrow.z * (at.z - float(z)));
        for (int z = from.z; z < int(size.z); ++z)
            for (int y = from.y; y <= to.y; ++y) {
                const float row = planes[z] * std::exp(-std::pow(narrow.y * (float(y) - at.y), 2.0f));
                float* texels = &light_[(size_t(z) * size.y + y) * size.x];
                for (int x = from.x; x <= to.x; ++x) texels[x] += row * columns[x];
            }
    }
}

// The thread's part of the particles, as shaders/slab_bins.comp.
void NativeSlabs::bin(uint32_t thread) {
    const native::Frame& f = frame_;
    std::vector<std::vector<uint32_t>>& lists = lists_[thread];
    for (std::vector<uint32_t>& list : lists) list.clear();
    const glm::mat3 axes = glm::mat3_cast(pose_.orientation);
    const float tile = f.spacing * float(kTile), end = f.depth + f.thickness * float(f.slabs);
    const float widest = std::max(std::abs(f.corner_x), std::abs(f.corner_y));
    const size_t first = particles_.size() * thread / threads_, last = particles_.size() * (thread + 1) / threads_;
    for (size_t i = first; i < last; ++i) {
        const gpu::Particle& p = particles_[i];
        const float u = p.scale * tick_.falloff, own = std::max(0.1f * u, 1e-18f);
        const float radius = physics::supportRadius(p.sigma_t, u, tick_.cut);
        if (radius <= 0) continue;
        const glm::vec3 c = p.centre - pose_.position;
        native::Member m{};
        m.x = glm::dot(axes[0], c), m.y = -glm::dot(axes[1], c), m.z = -glm::dot(axes[2], c);
        const float across = std::max(own, f.rate > 1 ? kLeastAcross * f.spacing * m.z : 0);
        const float along = std::max(own, kLeastAlong * f.thickness);
        m.across = 0.5f * std::numbers::log2e_v<float> / (across * across);
        m.along = 0.5f * std::numbers::log2e_v<float> / (along * along);
        m.sigma = p.sigma_t * (own / across) * (own / across) * (own / along);
        if (along > own) m.sigma *= physics::widenedShare(own, along, f.depth - m.z, end - m.z);
        const float wide = radius * across / own, deep = radius * along / own;
        const float near = std::max(m.z - deep, f.depth), far = std::min(m.z + deep, end);
        if (far <= near) continue;
        m.first = uint32_t((near - f.depth) / f.thickness);
        m.last = std::min(uint32_t((far - f.depth) / f.thickness), f.slabs - 1);
        const float a_slab = f.thickness * std::sqrt(m.across * 2 * widest * widest + m.along);
        m.run = uint32_t(std::clamp(std::sqrt(kMostSpread) / a_slab, 1.0f, float(kMostRun)));
        members_[i] = m;
        const auto tilesOf = [&](float at, float corner, uint32_t count) { // of the box around it
            const float lo = (std::min((at - wide) / near, (at - wide) / far) - corner) / tile - 1e-3f;
            const float hi = (std::max((at + wide) / near, (at + wide) / far) - corner) / tile + 1e-3f;
            return std::pair(uint32_t(std::clamp(std::floor(lo), 0.0f, float(count))),
                             uint32_t(std::clamp(std::floor(hi) + 1, 0.0f, float(count))));
        };
        const auto [left, right] = tilesOf(m.x, f.corner_x, tiles_.x);
        const auto [top, bottom] = tilesOf(m.y, f.corner_y, tiles_.y);
        for (uint32_t y = top; y < bottom; ++y)
            for (uint32_t x = left; x < right; ++x) lists[y * tiles_.x + x].push_back(uint32_t(i));
    }
}

// A row of nodes, as shaders/slab_spline.comp.
void NativeSlabs::fitSpline(uint32_t y) {
    constexpr float kInverse[5] = {0.04439f, -0.33987f, 1.59096f, -0.33987f, 0.04439f};
    for (uint32_t x = 0; x < nodes_.x; ++x) {
        float depth = 0, share = 0, unknown = 0, around = 0, weights = 0;
        for (int j = 0; j < 5; ++j)
            for (int i = 0; i < 5; ++i) {
                const glm::ivec2 at =
                    glm::clamp(glm::ivec2(x, y) + glm::ivec2(i, j) - 2, glm::ivec2(0), glm::ivec2(nodes_) - 1);
                const size_t node = size_t(at.y) * frame_.nodes + size_t(at.x);
                const float inverse = kInverse[i] * kInverse[j];
                depth += inverse * field_[0][node];
                if (field_[0][node] > 0) {
                    const float near = 1.0f / float(1 + (i - 2) * (i - 2) + (j - 2) * (j - 2));
                    share += inverse * field_[1][node];
                    around += near * field_[1][node];
                    weights += near;
                } else {
                    unknown += inverse;
                }
            }
        spline_[0][y * frame_.nodes + x] = depth;
        spline_[1][y * frame_.nodes + x] = share + unknown * around / std::max(weights, 1e-6f);
    }
}

template <class Barrier>
void NativeSlabs::work(uint32_t thread, Barrier& together) {
    flushTiny();
    bin(thread);
    together.arrive_and_wait();
    std::vector<uint32_t> members;
    Spent spent;
    float* scratch = scratch_[thread].data();
    for (uint32_t tile; (tile = next_tile_.fetch_add(1)) < tiles_.x * tiles_.y;) {
        const Clock::time_point begin = Clock::now();
        members.clear();
        for (const auto& lists : lists_) members.insert(members.end(), lists[tile].begin(), lists[tile].end());
        kernel_.add(frame_, tile % tiles_.x, tile / tiles_.x, members.data(), members.size(), scratch);
        const double added = since(begin);
        kernel_.light(frame_, tile % tiles_.x, tile / tiles_.x, scratch);
        spent.slabs += added;
        spent.light += since(begin) - added;
    }
    thread_spent_[thread] = spent;
    together.arrive_and_wait();
    for (uint32_t y = thread; y < nodes_.y; y += threads_) fitSpline(y);
    together.arrive_and_wait();
    for (uint32_t row; (row = next_row_.fetch_add(kRowsAtOnce)) < size_.y;)
        for (uint32_t y = row; y < std::min(row + kRowsAtOnce, size_.y); ++y) kernel_.row(frame_, y, scratch);
    together.arrive_and_wait();
}

void NativeSlabs::render() {
    next_tile_ = next_row_ = 0;
    thread_spent_.assign(threads_, {});
    std::vector<double> done; // ms, of bins, tiles, spline, rows
    const Clock::time_point begin = Clock::now();
    const auto note = [&]() noexcept { done.push_back(since(begin)); };
    done.reserve(4);
    std::barrier together(std::ptrdiff_t(threads_), note);
    {
        std::vector<std::jthread> others;
        for (uint32_t i = 1; i < threads_; ++i) others.emplace_back([&, i] { work(i, together); });
        work(0, together);
    }
    spent_ = {.bin = done[0], .rows = done[3] - done[1]};
    for (const Spent& thread : thread_spent_) {
        spent_.slabs += thread.slabs / double(threads_);
        spent_.light += thread.light / double(threads_);
    }
}

uint64_t NativeSlabs::samples() const {
    uint64_t slabs = 0;
    for (const auto& lists : lists_)
        for (const std::vector<uint32_t>& list : lists)
            for (const uint32_t i : list) slabs += members_[i].last - members_[i].first + 1;
    return slabs * kRays;
}

RadianceImage NativeSlabs::picture() const {
    RadianceImage image{int(size_.x), int(size_.y), {}, {}};
    for (uint32_t y = 0; y < size_.y; ++y)
        for (uint32_t x = 0; x < size_.x; ++x) {
            const size_t at = size_t(y) * frame_.width + x;
            image.radiance.emplace_back(picture_[0][at], picture_[1][at], picture_[2][at]);
            image.transmittance.push_back(picture_[3][at]);
        }
    return image;
}

} // namespace brume::bench
