// Corrections: what measuring says of the plan's laws. A factor on the predicted error for each viewer, method and
// accuracy, which follows the measured error over that of the laws. Laws may be too low for coarse settings and too
// high for fine ones.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace brume {

// Up at once, so that a broken promise is mended. Down slowly, and only after a while without a rise. A fall that is
// followed by a rise was wrong: the next one waits twice as long. So two ways whose laws are wrong in opposite
// directions cannot take turns for ever: at most once every kLongestWait.
class Corrections {
public:
    using Time = std::chrono::steady_clock::time_point;
    static constexpr double kLeast = 0.25, kMost = 16; // factors
    static constexpr std::chrono::seconds kFirstWait{10}, kLongestWait{640};

    // Measured relative RMSE over the laws', and its 95 % bounds.
    struct Ratio {
        double middle = 1, low = 1, high = 1;
    };
    // `law`: the error that the laws predicted for what was measured.
    void learn(uint32_t viewer, const std::string& method, double law, const Ratio& measured, Time now);
    // Viewers that are not measured any more go back to 1, by half in a minute. To be called now and then.
    void fade(Time now);
    // Another scene or other settings: nothing is known.
    void forget() { of_.clear(); }

    // On an error of the laws. Where nothing is known of the method: 1. Between accuracies that were measured: between
    // their factors; beyond them: as the nearest. A viewer who is new has the largest factor of the others, which see
    // the same medium.
    double factor(uint32_t viewer, std::string_view method, double law) const;

    // Of what was measured of that viewer's pictures, by any method. 1 if nothing was.
    double largest(uint32_t viewer) const;

    // True: that viewer's pictures by that method were measured.
    bool knows(uint32_t viewer, std::string_view method) const;

private:
    struct Learnt {
        double factor = 1;
        std::chrono::seconds wait = kFirstWait; // after a rise, before it may fall
        Time learnt{}, risen{};
        bool fallen = false; // True: it has fallen since the last rise
    };
    using OfMethod = std::map<int, Learnt>; // by accuracyOf() the law
    static double between(const OfMethod& known, double law);
    std::map<std::pair<uint32_t, std::string>, OfMethod> of_; // by viewer and method; none is empty
};

} // namespace brume
