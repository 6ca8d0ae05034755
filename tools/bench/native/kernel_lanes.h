// The kernels, for vectors of kLanes floats; included by one file for each set of instructions, which defines kLanes,
// gather() and permute(). Everything here is local to that file.

#include "tools/bench/native/kernel.h"

namespace brume::bench::native {
namespace {

Floats all(float x) { return Floats{} + x; }
Floats load(const float* from) {
    Floats v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}
void store(float* to, Floats v) { __builtin_memcpy(to, &v, sizeof v); }
Floats choose(Ints mask, Floats yes, Floats no) { return (Floats)(((Ints)yes & mask) | ((Ints)no & ~mask)); }
Floats larger(Floats a, Floats b) { return choose(a > b, a, b); }
Floats smaller(Floats a, Floats b) { return choose(a < b, a, b); }
Floats magnitude(Floats x) { return (Floats)((Ints)x & 0x7fffffff); }
Floats floored(Floats x) { return __builtin_convertvector(__builtin_convertvector(x, Ints), Floats); } // of x >= 0
Floats squareRoot(Floats x) {
    for (unsigned i = 0; i < kLanes; ++i) x[i] = __builtin_sqrtf(x[i]);
    return x;
}
bool any(Ints mask) {
    int some = 0;
    for (unsigned i = 0; i < kLanes; ++i) some |= mask[i];
    return some != 0;
}

// 2^x: Taylor's series of the part within half an octave, relative error 2e-7; 0 below -126.
[[gnu::always_inline]] inline Floats exp2(Floats x) {
    const Floats bounded = smaller(larger(x, all(-126.0f)), all(126.0f));
    constexpr float kRound = 12582912.0f; // 1.5 * 2^23: adding it rounds to whole numbers
    const Floats shifted = bounded + kRound;
    const Floats f = bounded - (shifted - kRound);
    Floats p = all(1.5403530e-4f);
    p = p * f + 1.3333558e-3f;
    p = p * f + 9.6181291e-3f;
    p = p * f + 5.5504109e-2f;
    p = p * f + 2.4022651e-1f;
    p = p * f + 6.9314718e-1f;
    p = p * f + 1.0f;
    const Ints octave = ((Ints)shifted) << 23; // what kRound adds falls out at the top
    return choose(x < -126.0f, Floats{}, (Floats)((Ints)p + octave));
}
Floats exponential(Floats x) { return exp2(x * 1.44269504f); }

// As shaders/shared/transmittance.h and scatter.h.
Floats phiSeries(Floats x) {
    return 1.0f - x * (0.5f - x * (1.0f / 6 - x * (1.0f / 24 - x * (1.0f / 120 - x * (1.0f / 720)))));
}
[[gnu::always_inline]] inline Floats phi(Floats x) {
    const Ints small = magnitude(x) < 0.25f;
    return choose(small, phiSeries(x), (1.0f - exponential(-x)) / choose(small, all(1), x));
}
Floats opacity(Floats x) { return x * phi(x); }
Floats scatterAnalytic(Floats depth, Floats light_in, Floats light_out) {
    const Floats out = depth + light_out;
    return depth * exponential(-smaller(light_in, out)) * phi(magnitude(out - light_in));
}
Floats scatterVaried(Floats depth, Floats light_in, Floats light_out, Floats slope, Floats bend) {
    const Floats rise = smaller(larger(light_out - light_in, all(-1e4f)), all(1e4f));
    const Floats bent = smaller(larger(bend, all(-1e4f)), all(1e4f)), fading = smaller(depth, all(1e4f)) + rise;
    const Floats part = (bent - slope * rise) / (12.0f + (fading * fading + 4.0f * bent * bent) * (1.0f / 3));
    return 1.0f + smaller(larger(part, all(-0.5f)), all(1));
}

// As shaders/lib/slab_march.glsl.
Floats beforeFirst(Floats x, Floats y, Floats z, Floats w) {
    const Floats parabola = 3.0f * (x - y) + z, cubic = x - w + 3.0f * (z - y), sum = x + y + z + w;
    return parabola + cubic * (sum * sum) / larger(sum * sum + 64.0f * cubic * cubic, all(1e-37f));
}

Ints counted() { // 0, 1, 2 ...
    Ints lane;
    for (unsigned i = 0; i < kLanes; ++i) lane[i] = int(i);
    return lane;
}

// Of a tile's rays: lane's column, and row counted from the vector's first.
Floats columns() { return __builtin_convertvector(counted() % int(kTile), Floats); }
Ints rowOfLane() { return counted() / int(kTile); }

// Adds a member to the slabs first ... end - 1 of the tile. On a ray both its factors, of columns and of rows, are
// exponentials of a parabola in view depth: two multiplications from slab to slab.
void addRun(const Frame& frame, const Member& m, Floats ray_x, Floats ray_y, uint32_t first, uint32_t end,
            float* added) {
    const float h = frame.thickness, z = frame.depth + (float(first) + 0.5f) * h, dz = z - m.z;
    const Floats dx = z * ray_x - m.x, dy = z * ray_y - m.y;
    Floats column = m.sigma * exp2(-m.across * dx * dx - m.along * dz * dz);
    Floats column_step = exp2(-m.across * h * ray_x * (2.0f * dx + h * ray_x) - m.along * h * (2.0f * dz + h));
    const Floats column_ratio = exp2(-2.0f * h * h * (m.across * ray_x * ray_x + m.along));
    Floats row = exp2(-m.across * dy * dy);
    Floats row_step = exp2(-m.across * h * ray_y * (2.0f * dy + h * ray_y));
    const Floats row_ratio = exp2(-2.0f * h * h * m.across * ray_y * ray_y);
    for (uint32_t slab = first; slab < end; ++slab) {
        float* sums = added + slab * kRays;
        for (unsigned v = 0; v < kRays / kLanes; ++v) {
            const Floats rows = permute(row, rowOfLane() + int(v * kLanes / kTile));
            store(sums + v * kLanes, load(sums + v * kLanes) + column * rows);
        }
        column *= column_step;
        column_step *= column_ratio;
        row *= row_step;
        row_step *= row_ratio;
    }
}

// Optical depth between the light and a place of its map, linear between its values.
Floats lightDepth(const Frame& frame, const Floats place[3]) {
    Ints at[3];
    Floats part[3];
    for (int axis = 0; axis < 3; ++axis) {
        const float last = float(frame.light_size[axis] - 1);
        const Floats x = smaller(larger(place[axis], Floats{}), all(last));
        const Floats below = smaller(floored(x), all(last - 1));
        at[axis] = __builtin_convertvector(below, Ints);
        part[axis] = x - below;
    }
    const int row = int(frame.light_size[0]), plane = row * int(frame.light_size[1]);
    const Ints first = at[2] * plane + at[1] * row + at[0];
    Floats planes[2];
    for (int p = 0; p < 2; ++p) {
        Floats rows[2];
        for (int r = 0; r < 2; ++r) {
            const float* from = frame.light + p * plane + r * row;
            const Floats left = gather(from, first), right = gather(from + 1, first);
            rows[r] = left + part[0] * (right - left);
        }
        planes[p] = rows[0] + part[1] * (rows[1] - rows[0]);
    }
    return planes[0] + part[2] * (planes[1] - planes[0]);
}

// A vector of the tile's rays, slab after slab from near to far: as shaders/slab_light.comp.
void lightRays(const Frame& frame, uint32_t x, uint32_t y, unsigned v, const float* added) {
    const Floats node_x = float(x * kTile) + columns();
    const Floats node_y = float(y * kTile + v * kLanes / kTile) + __builtin_convertvector(rowOfLane(), Floats);
    const Floats ray_x = frame.corner_x + frame.spacing * node_x, ray_y = frame.corner_y + frame.spacing * node_y;
    const Floats length = frame.thickness * squareRoot(1.0f + ray_x * ray_x + ray_y * ray_y);
    Floats way[3];
    for (int axis = 0; axis < 3; ++axis)
        way[axis] = frame.ray[axis] + node_x * frame.right[axis] + node_y * frame.down[axis];
    const auto lightAt = [&](float z) {
        Floats place[3];
        for (int axis = 0; axis < 3; ++axis) place[axis] = frame.eye[axis] + z * way[axis];
        return lightDepth(frame, place);
    };
    const auto middle = [&](uint32_t slab) {
        return slab < frame.slabs ? load(added + slab * kRays + v * kLanes) : Floats{};
    };
    Floats depth{}, scattered{}, light[4]{}; // light: at the face before the slab's near one, its own two, the next
    bool known = false;                      // the light at the slab's own faces
    Floats here = middle(0), next = middle(1), before = beforeFirst(here, next, middle(2), middle(3));
    before = smaller(larger(before, Floats{}), here * here / larger(next, all(1e-30f)));
    for (uint32_t slab = 0; slab < frame.slabs; ++slab) {
        if (slab + 1 == frame.slabs)
            next = smaller(larger(2.0f * here - before, Floats{}), here * here / larger(before, all(1e-30f)));
        const Floats mean = here + (before - 2.0f * here + next) * (1.0f / 24);
        const Floats own = larger(mean, Floats{}) * length;
        const bool some = any(own > 0.0f);
        if (some) {
            const float face = frame.depth + float(slab) * frame.thickness;
            if (!known) {
                light[1] = lightAt(face), light[2] = lightAt(face + frame.thickness);
                light[0] = lightAt(face - frame.thickness);
            }
            light[3] = lightAt(face + 2 * frame.thickness);
            const Floats varies = 0.5f * (next - before) / choose(mean > 0.0f, mean, all(1));
            const Floats slope = smaller(larger(varies, all(-2)), all(2));
            const Floats bend = 0.5f * (light[3] - light[2] - light[1] + light[0]);
            scattered += exponential(-depth) * scatterAnalytic(own, light[1], light[2]) *
                         scatterVaried(own, light[1], light[2], slope, bend);
            depth += own;
            for (int i = 0; i < 3; ++i) light[i] = light[i + 1];
        }
        known = some;
        before = here;
        here = next;
        next = middle(slab + 2);
    }
    for (unsigned part = 0; part < kLanes / kTile; ++part) {
        const size_t node = size_t(y * kTile + v * kLanes / kTile + part) * frame.nodes + x * kTile;
        const Floats share = scattered / larger(opacity(depth), all(1e-30f));
        for (unsigned i = 0; i < kTile; ++i) {
            frame.field[0][node + i] = depth[part * kTile + i];
            frame.field[1][node + i] = share[part * kTile + i];
        }
    }
}

void addTile(const Frame& frame, uint32_t x, uint32_t y, const uint32_t* list, size_t count, float* added) {
    __builtin_memset(added, 0, size_t(frame.slabs) * kRays * sizeof(float));
    const Floats ray_x = frame.corner_x + frame.spacing * (float(x * kTile) + columns());
    const Floats ray_y = frame.corner_y + frame.spacing * (float(y * kTile) + columns());
    for (size_t i = 0; i < count; ++i) {
        const Member& m = frame.members[list[i]];
        for (uint32_t first = m.first; first <= m.last; first += m.run) {
            const uint32_t end = first + m.run < m.last + 1 ? first + m.run : m.last + 1;
            addRun(frame, m, ray_x, ray_y, first, end, added);
        }
    }
}

void lightTile(const Frame& frame, uint32_t x, uint32_t y, const float* added) {
    for (unsigned v = 0; v < kRays / kLanes; ++v) lightRays(frame, x, y, v, added);
}

// A cubic B-spline's weights of the nodes at -1, 0, 1, 2, as in shaders/lib/slab_field.glsl.
void cubic(float t, float weights[4]) {
    const float r = 1 - t;
    weights[0] = r * r * r / 6;
    weights[1] = ((3 * t - 6) * t * t + 4) / 6;
    weights[2] = ((3 * r - 6) * r * r + 4) / 6;
    weights[3] = t * t * t / 6;
}

void makeRow(const Frame& frame, uint32_t y, float* scratch) {
    float down[4];
    cubic(float(y % frame.rate) / float(frame.rate), down);
    for (int what = 0; what < 2; ++what) {
        const float* first = frame.spline[what] + size_t(y / frame.rate) * frame.nodes;
        for (uint32_t node = 0; node < frame.nodes; node += kLanes) {
            Floats sum{};
            for (int j = 0; j < 4; ++j) sum += down[j] * load(first + size_t(j) * frame.nodes + node);
            store(scratch + size_t(what) * frame.nodes + node, sum);
        }
    }
    const Ints own = counted() / int(frame.rate); // lane's cell, from the vector's first
    const uint32_t period = frame.rate > kMostLanes ? frame.rate : kMostLanes;
    for (uint32_t x = 0; x < frame.width; x += kLanes) {
        const float* cell = scratch + x / frame.rate;
        Floats depth{}, share{};
        for (int j = 0; j < 4; ++j) {
            const Floats weight = load(frame.weights[j] + x % period);
            depth += weight * permute(load(cell + j), own);
            share += weight * permute(load(cell + frame.nodes + j), own);
        }
        const Floats opaque = opacity(larger(depth, Floats{})), scattered = larger(share, Floats{}) * opaque;
        const size_t at = size_t(y) * frame.width + x;
        for (int c = 0; c < 3; ++c) store(frame.picture[c] + at, frame.colour[c] * scattered);
        store(frame.picture[3] + at, 1.0f - opaque);
    }
}

} // namespace
} // namespace brume::bench::native
