// ErrorWindow: the relative RMSE of pictures, estimated from pixels that were traced anew in double precision.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <string>

#include <glm/glm.hpp>

namespace brume {

// A pixel that shows the medium, and is no edge (docs/conventions.md): radiance as drawn, and of the reference.
struct PixelError {
    glm::vec3 value{0}, reference{0};
};

// True values lie in [low, high] in 95 % of cases, from 300 pixels on. Errors that sit in one pixel of fifty need all
// that a window keeps: with 300 pixels the interval holds the true value of such errors in 88 % of cases only.
struct ErrorEstimate {
    static constexpr size_t kLeast = 100;
    size_t pixels = 0;
    double rmse = 0, low = 0, high = 0; // relative RMSE
    double bias = 0;                    // mean of (value - reference) / reference
    double law = 0;                     // relative RMSE, as the plan's laws predict it for the same pixels
    bool known() const { return pixels >= kLeast; }
    bool operator==(const ErrorEstimate&) const = default;
    // Measured error over that of the laws; 1 if either is unknown.
    double correction() const { return known() && law > 0 ? rmse / law : 1; }
};

// Of one viewer's pictures by one method.
struct ViewError {
    uint32_t viewer = 0;
    std::string method;
    ErrorEstimate error, newest; // of the last half minute; of the newest pixels
};

// Keeps the pixels of the last half minute, at most kMost of them.
class ErrorWindow {
public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr size_t kMost = 1024;
    static constexpr std::chrono::seconds kKept{30};

    // Pixels of one picture. `law`: the relative RMSE that the laws predict for it.
    void add(std::span<const PixelError> pixels, double law, Time now);
    void forget() { pixels_.clear(); }
    Time last() const { return pixels_.empty() ? Time{} : pixels_.back().at; }
    // Channels where the reference is below 1/1000 of the window's largest are left out.
    // `newest`: of at most so many of the newest pixels.
    ErrorEstimate estimate(Time now, size_t newest = kMost) const;

private:
    struct Kept {
        PixelError pixel;
        double law;
        Time at;
    };
    std::deque<Kept> pixels_;
};

} // namespace brume
