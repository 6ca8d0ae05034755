// How long one viewer's newest frames took in each stage. Bounded: the newest kFrames of them. A machine without a clock of its
// own.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "server/viewer/frame.h"

namespace brume {

class History {
public:
    static constexpr size_t kFrames = 256, kStages = 5;
    static constexpr std::array<const char*, kStages> kNames{"wait", "render", "encode", "queue", "gpu"}; // gpu: part of render
    static constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();                            // does not count
    using Stages = std::array<float, kStages>;                                                            // ms

    void add(const Stages& stages, Clock::time_point now);

    struct Percentiles {
        float p50 = 0, p95 = 0, p99 = 0; // ms, by nearest rank; 0 without frames
    };
    Percentiles of(size_t stage) const;
    // Frames a second in the three seconds before `now`, as far as they are remembered.
    float rate(Clock::time_point now) const;

private:
    struct Sample {
        Stages stages{};
        Clock::time_point at{};
    };
    std::array<Sample, kFrames> ring_;
    size_t frames_ = 0; // ever
};

} // namespace brume
