// Particle state as structure of arrays, one column per number, so that the loops of a step vectorise.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace brume {

enum class Column : uint32_t {
    x,
    y,
    z, // m, world
    vx,
    vy,
    vz,     // m/s
    scale,  // m, centre to vertex
    weight, // extinction's multiplier * 1e-4; where points bring their own sigma_t, that (1/m)
    sigma,  // 1/m, now
    home_x, // home: m, target relative to the volume. Particles of an emitter have no
    home_y, // target; for them these columns hold the age (s)
    home_z, // and the scale at birth (m)
    count,
    age = home_x,
    birth_scale = home_y,
};

// Rows [begin, end) of every column.
struct Rows {
    uint32_t begin = 0, end = 0;
};

class Columns {
public:
    explicit Columns(uint32_t rows)
        : stride_((size_t{rows} + kPage - 1) / kPage * kPage + kSkew),
          data_(stride_ * static_cast<size_t>(Column::count)) {}

    float* operator[](Column c) { return data_.data() + stride_ * static_cast<size_t>(c); }
    const float* operator[](Column c) const { return data_.data() + stride_ * static_cast<size_t>(c); }
    uint64_t bytes() const { return data_.size() * sizeof(float); }
    // Precondition: both have the same number of rows. Allocates nothing.
    void copyFrom(const Columns& other) { std::copy(other.data_.begin(), other.data_.end(), data_.begin()); }

private:
    // One row of all columns is read together. Without the skew these reads would share the same sets of the
    // first-level cache.
    static constexpr size_t kPage = 1024, kSkew = 80; // floats: 4 KiB, and 5 cache lines
    size_t stride_;
    std::vector<float> data_;
};

} // namespace brume
