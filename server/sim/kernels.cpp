#include "server/sim/kernels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "common/scene_limits.h"
#include "server/sim/sine.h"

// One copy of a loop for AVX2 and one for any x86-64, chosen at start. Neither contracts nor reorders, so both give the
// same bits. Not under sanitizers: the choice is made before their run-time is up.
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__OPTIMIZE__) && !defined(BRUME_SANITIZED)
#define BRUME_CLONES __attribute__((target_clones("avx2", "default")))
#else
#define BRUME_CLONES
#endif
#define BRUME_INLINE inline __attribute__((always_inline)) // a clone cannot call what was compiled for another target

// Columns never overlap. As parameters, because only there do compilers believe it.
#define BRUME_OUT float* __restrict
#define BRUME_IN const float* __restrict

namespace brume {

namespace {

constexpr size_t kLanes = 16; // particles taken together where a loop has a loop inside, or a result over all

// By value: std::min's references are control flow to a vectoriser.
BRUME_INLINE float lower(float a, float b) { return b < a ? b : a; }
BRUME_INLINE float upper(float a, float b) { return a < b ? b : a; }

// 0 below 0, 1 above 1, smooth between.
BRUME_INLINE float smooth(float t) {
    t = lower(upper(t, 0.0f), 1.0f);
    return t * t * (3 - 2 * t);
}

BRUME_CLONES void springAxis(BRUME_OUT x, BRUME_OUT v, BRUME_IN home, size_t n, float volume, float pull, float damp,
                             float dt) {
    for (size_t i = 0; i < n; ++i) {
        v[i] = (v[i] + pull * (home[i] + volume - x[i])) * damp;
        x[i] = x[i] + dt * v[i];
    }
}

// kLanes particles.
BRUME_INLINE void plumeTile(BRUME_OUT x, BRUME_OUT y, BRUME_OUT z, BRUME_OUT vx, BRUME_OUT vy, BRUME_OUT vz,
                            BRUME_OUT age, const PlumeStep& s, const Turbulence::Modes& modes) {
    alignas(64) float ux[kLanes] = {}, uy[kLanes] = {}, uz[kLanes] = {};
    for (const Mode& mode : modes) {
        for (size_t j = 0; j < kLanes; ++j) {
            const float wave = sineOfTurns(mode.wave.x * x[j] + mode.wave.y * y[j] + mode.wave.z * z[j] + mode.phase);
            ux[j] += mode.amplitude.x * wave;
            uy[j] += mode.amplitude.y * wave;
            uz[j] += mode.amplitude.z * wave;
        }
    }
    const float damp = 1 / (1 + s.dt * s.viscosity), drag = s.dt * s.viscosity, per_life = 1 / s.life;
    for (size_t j = 0; j < kLanes; ++j) {
        const float lift = s.dt * s.buoyancy * (1 - age[j] * per_life);
        vx[j] = (vx[j] + drag * (s.wind.x + ux[j])) * damp;
        vy[j] = (vy[j] + drag * (s.wind.y + uy[j]) + lift) * damp;
        vz[j] = (vz[j] + drag * (s.wind.z + uz[j])) * damp;
        x[j] = x[j] + s.dt * vx[j];
        y[j] = y[j] + s.dt * vy[j];
        z[j] = z[j] + s.dt * vz[j];
        age[j] = age[j] + s.dt;
    }
}

BRUME_CLONES void plumeTiles(BRUME_OUT x, BRUME_OUT y, BRUME_OUT z, BRUME_OUT vx, BRUME_OUT vy, BRUME_OUT vz,
                             BRUME_OUT age, size_t tiles, const PlumeStep& step, const Turbulence::Modes& modes) {
    const PlumeStep s = step;
    for (size_t i = 0; i < tiles * kLanes; i += kLanes)
        plumeTile(x + i, y + i, z + i, vx + i, vy + i, vz + i, age + i, s, modes);
}

BRUME_CLONES void ageRun(BRUME_OUT scale, BRUME_OUT sigma, BRUME_IN age, BRUME_IN birth_scale, BRUME_IN weight,
                         size_t n, const Ageing& ageing) {
    const float growth = ageing.growth, extinction = ageing.extinction, life = ageing.life;
    const float per_appear = 1 / std::min(Ageing::kAppear, 0.1f * life), per_dissolve = 1 / (Ageing::kDissolve * life);
    for (size_t i = 0; i < n; ++i) {
        const float grown = birth_scale[i] + growth * age[i], shrink = birth_scale[i] / grown;
        const float there = smooth(age[i] * per_appear) * smooth((life - age[i]) * per_dissolve);
        scale[i] = grown;
        sigma[i] = extinction * weight[i] * (shrink * shrink * shrink) * there;
    }
}

BRUME_CLONES void pushRun(BRUME_IN x, BRUME_IN y, BRUME_IN z, BRUME_OUT vx, BRUME_OUT vy, BRUME_OUT vz, size_t n,
                          const Push& push) {
    const Push p = push;
    const float per_radius2 = 1 / (p.radius * p.radius), core = 0.1f * p.radius;
    constexpr float kMost = static_cast<float>(limits::kSpeed.hi);
    for (size_t i = 0; i < n; ++i) {
        const float ox = x[i] - p.origin.x, oy = y[i] - p.origin.y, oz = z[i] - p.origin.z;
        const float ahead = ox * p.direction.x + oy * p.direction.y + oz * p.direction.z;
        const float dx = ox - ahead * p.direction.x, dy = oy - ahead * p.direction.y, dz = oz - ahead * p.direction.z;
        const float d2 = dx * dx + dy * dy + dz * dz;
        const float near = upper(1 - d2 * per_radius2, 0.0f);
        const float weight = ahead > 0 ? near * near : 0.0f;
        const float radial = p.away / (std::sqrt(d2) + core);
        vx[i] = lower(upper(vx[i] + weight * (p.along.x + radial * dx), -kMost), kMost);
        vy[i] = lower(upper(vy[i] + weight * (p.along.y + radial * dy), -kMost), kMost);
        vz[i] = lower(upper(vz[i] + weight * (p.along.z + radial * dz), -kMost), kMost);
    }
}

BRUME_CLONES void scaleRun(BRUME_OUT out, BRUME_IN in, size_t n, float factor) {
    for (size_t i = 0; i < n; ++i) out[i] = in[i] * factor;
}

BRUME_CLONES void scaleRunAtMost(BRUME_OUT out, BRUME_IN in, size_t n, float factor, float most) {
    for (size_t i = 0; i < n; ++i) out[i] = lower(in[i] * factor, most);
}

struct LowHigh {
    float lo, hi;
};

// A minimum and a maximum per lane, joined at the end: comparisons give the same result in any order. Precondition: n >
// 0.
BRUME_CLONES LowHigh lowHigh(BRUME_IN values, size_t n) {
    constexpr size_t kWide = 64; // more than GCC unrolls before it vectorises
    float lo[kWide], hi[kWide];
    for (size_t j = 0; j < kWide; ++j) lo[j] = hi[j] = values[0];
    size_t i = 0;
    for (; i + kWide <= n; i += kWide) {
        for (size_t j = 0; j < kWide; ++j) {
            lo[j] = lower(lo[j], values[i + j]);
            hi[j] = upper(hi[j], values[i + j]);
        }
    }
    for (; i < n; ++i) {
        lo[0] = lower(lo[0], values[i]);
        hi[0] = upper(hi[0], values[i]);
    }
    LowHigh out{lo[0], hi[0]};
    for (size_t j = 1; j < kWide; ++j) out = {lower(out.lo, lo[j]), upper(out.hi, hi[j])};
    return out;
}

} // namespace

void springStep(Columns& c, Rows rows, const SpringStep& s) {
    constexpr std::array<std::array<Column, 3>, 3> kAxes{{{Column::x, Column::vx, Column::home_x},
                                                          {Column::y, Column::vy, Column::home_y},
                                                          {Column::z, Column::vz, Column::home_z}}};
    const size_t b = rows.begin, n = rows.end - rows.begin;
    for (int axis = 0; axis < 3; ++axis) {
        const auto& [x, v, home] = kAxes[static_cast<size_t>(axis)];
        springAxis(c[x] + b, c[v] + b, c[home] + b, n, s.volume[axis], s.dt * s.spring, 1 / (1 + s.dt * s.viscosity),
                   s.dt);
    }
}

void plumeStep(Columns& c, Rows rows, const PlumeStep& s, const Turbulence::Modes& turbulence) {
    constexpr std::array<Column, 7> kTaken{Column::x,  Column::y,  Column::z,  Column::vx,
                                           Column::vy, Column::vz, Column::age};
    const size_t b = rows.begin, n = rows.end - rows.begin, tiles = n / kLanes, rest = n % kLanes;
    plumeTiles(c[Column::x] + b, c[Column::y] + b, c[Column::z] + b, c[Column::vx] + b, c[Column::vy] + b,
               c[Column::vz] + b, c[Column::age] + b, tiles, s, turbulence);
    if (rest == 0) return;
    // The last tile is filled up beside the columns: the rows behind it belong to others.
    float tile[kTaken.size()][kLanes] = {};
    for (size_t t = 0; t < kTaken.size(); ++t) std::copy_n(c[kTaken[t]] + b + tiles * kLanes, rest, tile[t]);
    plumeTiles(tile[0], tile[1], tile[2], tile[3], tile[4], tile[5], tile[6], 1, s, turbulence);
    for (size_t t = 0; t < kTaken.size(); ++t) std::copy_n(tile[t], rest, c[kTaken[t]] + b + tiles * kLanes);
}

void age(Columns& c, Rows rows, const Ageing& ageing) {
    const size_t b = rows.begin;
    ageRun(c[Column::scale] + b, c[Column::sigma] + b, c[Column::age] + b, c[Column::birth_scale] + b,
           c[Column::weight] + b, rows.end - b, ageing);
}

void push(Columns& c, Rows rows, const Push& push) {
    const size_t b = rows.begin;
    pushRun(c[Column::x] + b, c[Column::y] + b, c[Column::z] + b, c[Column::vx] + b, c[Column::vy] + b,
            c[Column::vz] + b, rows.end - b, push);
}

void setSigma(Columns& c, Rows rows, float extinction) {
    scaleRun(c[Column::sigma] + rows.begin, c[Column::weight] + rows.begin, rows.end - rows.begin, extinction);
}

void scaleSigma(Columns& c, Rows rows, float factor) {
    scaleRunAtMost(c[Column::sigma] + rows.begin, c[Column::weight] + rows.begin, rows.end - rows.begin, factor,
                   static_cast<float>(limits::kSigmaT.hi));
}

void widen(Bounds& bounds, const Columns& c, Rows rows) {
    const size_t n = rows.end - rows.begin;
    if (n == 0) return;
    const auto of = [&](Column column) { return lowHigh(c[column] + rows.begin, n); };
    constexpr std::array<Column, 3> kPlace{Column::x, Column::y, Column::z};
    for (int axis = 0; axis < 3; ++axis) {
        const LowHigh along = of(kPlace[static_cast<size_t>(axis)]);
        bounds.lo[axis] = std::min(bounds.lo[axis], along.lo);
        bounds.hi[axis] = std::max(bounds.hi[axis], along.hi);
    }
    bounds.max_scale = std::max(bounds.max_scale, of(Column::scale).hi);
    bounds.max_sigma_t = std::max(bounds.max_sigma_t, of(Column::sigma).hi);
}

} // namespace brume
