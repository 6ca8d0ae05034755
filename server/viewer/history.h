// Times of one viewer's newest kFrames frames in each stage, with percentiles and the frame rate. It has no clock:
// callers pass the time.
#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "server/viewer/frame.h"

namespace brume {

class History {
public:
    static constexpr size_t kFrames = 256, kStages = 5;
    // The stage gpu is a part of render.
    static constexpr std::array<const char*, kStages> kNames{"wait", "render", "encode", "queue", "gpu"};
    static constexpr float kUnknown =
        std::numeric_limits<float>::quiet_NaN(); // a stage that was not measured; left out of percentiles
    using Stages = std::array<float, kStages>;   // ms, by kNames

    void add(const Stages& stages, Clock::time_point now);

    struct Percentiles {
        float p50 = 0, p95 = 0, p99 = 0; // ms, nearest rank; 0 without frames
    };
    Percentiles of(size_t stage) const;
    // Frames per second over the three seconds before `now`, or over the remembered frames where those span less.
    float rate(Clock::time_point now) const;

private:
    struct Sample {
        Stages stages{};
        Clock::time_point at{};
    };
    std::array<Sample, kFrames> ring_;
    size_t frames_ = 0; // added so far, also those overwritten
};

} // namespace brume
