#include "server/sim/kernels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/scene_limits.h"
#include "server/sim/sine.h"

// One copy of a loop for AVX2 and one for any x86-64, chosen at start. Neither contracts nor reorders, so both give the same
// bits. Not under sanitizers: the choice is made before their run-time is up.
#if defined(__has_feature)
#define BRUME_HAS_FEATURE(x) __has_feature(x)
#else
#define BRUME_HAS_FEATURE(x) 0
#endif
#if defined(__x86_64__) && defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) &&              \
    !BRUME_HAS_FEATURE(address_sanitizer) && !BRUME_HAS_FEATURE(thread_sanitizer) && defined(__OPTIMIZE__)
#define BRUME_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define BRUME_CLONES
#endif
#define BRUME_INLINE inline __attribute__((always_inline))

namespace brume {

namespace {

constexpr uint32_t kLanes = 16; // particles taken together where a loop has a loop inside, or a result over all

// 0 below 0, 1 above 1, smooth between.
BRUME_INLINE float smooth(float t) {
    t = std::min(std::max(t, 0.0f), 1.0f);
    return t * t * (3 - 2 * t);
}

} // namespace

BRUME_CLONES void springStep(Columns& columns, Rows rows, const SpringStep& step) {
    const SpringStep s = step;
    const float damp = 1 / (1 + s.dt * s.viscosity);
    constexpr std::array<Column, 3> kPlace{Column::x, Column::y, Column::z}, kSpeed{Column::vx, Column::vy, Column::vz},
        kHome{Column::home_x, Column::home_y, Column::home_z};
    for (size_t axis = 0; axis < 3; ++axis) {
        float* __restrict x = columns[kPlace[axis]];
        float* __restrict v = columns[kSpeed[axis]];
        const float* __restrict home = columns[kHome[axis]];
        const float volume = s.volume[static_cast<int>(axis)], pull = s.dt * s.spring;
        for (uint32_t i = rows.begin; i < rows.end; ++i) {
            v[i] = (v[i] + pull * (home[i] + volume - x[i])) * damp;
            x[i] = x[i] + s.dt * v[i];
        }
    }
}

BRUME_CLONES void plumeStep(Columns& columns, Rows rows, const PlumeStep& step, const Turbulence::Modes& turbulence) {
    const PlumeStep s = step;
    const float damp = 1 / (1 + s.dt * s.viscosity), drag = s.dt * s.viscosity, per_life = 1 / s.life;
    float* __restrict x = columns[Column::x];
    float* __restrict y = columns[Column::y];
    float* __restrict z = columns[Column::z];
    float* __restrict vx = columns[Column::vx];
    float* __restrict vy = columns[Column::vy];
    float* __restrict vz = columns[Column::vz];
    float* __restrict age = columns[Column::age];

    for (uint32_t begin = rows.begin; begin < rows.end; begin += kLanes) {
        const uint32_t n = std::min(kLanes, rows.end - begin);
        alignas(64) float px[kLanes] = {}, py[kLanes] = {}, pz[kLanes] = {};
        alignas(64) float ux[kLanes] = {}, uy[kLanes] = {}, uz[kLanes] = {};
        for (uint32_t j = 0; j < n; ++j) {
            px[j] = x[begin + j];
            py[j] = y[begin + j];
            pz[j] = z[begin + j];
        }
        for (const Mode& mode : turbulence) {
            for (uint32_t j = 0; j < kLanes; ++j) {
                const float wave = sineOfTurns(mode.wave.x * px[j] + mode.wave.y * py[j] + mode.wave.z * pz[j] + mode.phase);
                ux[j] += mode.amplitude.x * wave;
                uy[j] += mode.amplitude.y * wave;
                uz[j] += mode.amplitude.z * wave;
            }
        }
        for (uint32_t j = 0; j < n; ++j) {
            const uint32_t i = begin + j;
            const float lift = s.dt * s.buoyancy * (1 - age[i] * per_life);
            vx[i] = (vx[i] + drag * (s.wind.x + ux[j])) * damp;
            vy[i] = (vy[i] + drag * (s.wind.y + uy[j]) + lift) * damp;
            vz[i] = (vz[i] + drag * (s.wind.z + uz[j])) * damp;
            x[i] = px[j] + s.dt * vx[i];
            y[i] = py[j] + s.dt * vy[i];
            z[i] = pz[j] + s.dt * vz[i];
            age[i] = age[i] + s.dt;
        }
    }
}

BRUME_CLONES void age(Columns& columns, Rows rows, const Ageing& ageing) {
    const Ageing a = ageing;
    const float per_appear = 1 / std::min(Ageing::kAppear, 0.1f * a.life), per_dissolve = 1 / (Ageing::kDissolve * a.life);
    const float* __restrict age = columns[Column::age];
    const float* __restrict birth_scale = columns[Column::birth_scale];
    const float* __restrict weight = columns[Column::weight];
    float* __restrict scale = columns[Column::scale];
    float* __restrict sigma = columns[Column::sigma];
    for (uint32_t i = rows.begin; i < rows.end; ++i) {
        const float grown = birth_scale[i] + a.growth * age[i], shrink = birth_scale[i] / grown;
        const float there = smooth(age[i] * per_appear) * smooth((a.life - age[i]) * per_dissolve);
        scale[i] = grown;
        sigma[i] = a.extinction * weight[i] * (shrink * shrink * shrink) * there;
    }
}

BRUME_CLONES void push(Columns& columns, Rows rows, const Push& push) {
    const Push p = push;
    const float per_radius2 = 1 / (p.radius * p.radius), core = 0.1f * p.radius;
    constexpr float kMost = static_cast<float>(limits::kSpeed.hi);
    const float* __restrict x = columns[Column::x];
    const float* __restrict y = columns[Column::y];
    const float* __restrict z = columns[Column::z];
    float* __restrict vx = columns[Column::vx];
    float* __restrict vy = columns[Column::vy];
    float* __restrict vz = columns[Column::vz];
    for (uint32_t i = rows.begin; i < rows.end; ++i) {
        const float ox = x[i] - p.origin.x, oy = y[i] - p.origin.y, oz = z[i] - p.origin.z;
        const float ahead = ox * p.direction.x + oy * p.direction.y + oz * p.direction.z;
        const float dx = ox - ahead * p.direction.x, dy = oy - ahead * p.direction.y, dz = oz - ahead * p.direction.z;
        const float d2 = dx * dx + dy * dy + dz * dz;
        const float near = std::max(1 - d2 * per_radius2, 0.0f);
        const float weight = ahead > 0 ? near * near : 0.0f;
        const float radial = p.away / (std::sqrt(d2) + core);
        vx[i] = std::min(std::max(vx[i] + weight * (p.along.x + radial * dx), -kMost), kMost);
        vy[i] = std::min(std::max(vy[i] + weight * (p.along.y + radial * dy), -kMost), kMost);
        vz[i] = std::min(std::max(vz[i] + weight * (p.along.z + radial * dz), -kMost), kMost);
    }
}

BRUME_CLONES void setSigma(Columns& columns, Rows rows, float extinction) {
    float* __restrict sigma = columns[Column::sigma];
    const float* __restrict weight = columns[Column::weight];
    for (uint32_t i = rows.begin; i < rows.end; ++i) sigma[i] = weight[i] * extinction;
}

namespace {

struct LowHigh {
    float lo, hi;
};

// A minimum and a maximum per lane, joined at the end: comparisons give the same result in any order.
BRUME_CLONES LowHigh lowHigh(const float* values, Rows rows) {
    float lo[kLanes], hi[kLanes];
    for (uint32_t j = 0; j < kLanes; ++j) lo[j] = hi[j] = values[rows.begin];
    uint32_t i = rows.begin;
    for (; i + kLanes <= rows.end; i += kLanes) {
        for (uint32_t j = 0; j < kLanes; ++j) {
            lo[j] = std::min(lo[j], values[i + j]);
            hi[j] = std::max(hi[j], values[i + j]);
        }
    }
    for (; i < rows.end; ++i) {
        lo[0] = std::min(lo[0], values[i]);
        hi[0] = std::max(hi[0], values[i]);
    }
    return {*std::min_element(lo, lo + kLanes), *std::max_element(hi, hi + kLanes)};
}

} // namespace

void widen(Bounds& bounds, const Columns& columns, Rows rows) {
    if (rows.begin == rows.end) return;
    constexpr std::array<Column, 3> kPlace{Column::x, Column::y, Column::z};
    for (int axis = 0; axis < 3; ++axis) {
        const LowHigh of = lowHigh(columns[kPlace[static_cast<size_t>(axis)]], rows);
        bounds.lo[axis] = std::min(bounds.lo[axis], of.lo);
        bounds.hi[axis] = std::max(bounds.hi[axis], of.hi);
    }
    bounds.max_scale = std::max(bounds.max_scale, lowHigh(columns[Column::scale], rows).hi);
    bounds.max_sigma_t = std::max(bounds.max_sigma_t, lowHigh(columns[Column::sigma], rows).hi);
}

} // namespace brume
