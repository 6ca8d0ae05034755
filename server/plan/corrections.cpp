#include "server/plan/corrections.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace brume {
namespace {

using Seconds = std::chrono::duration<double>;

constexpr double kCreep = 2, kFall = 5; // s, in which a difference shrinks to 1 / e: upward while uncertain; downward
constexpr double kFade = 60;            // s, in which the logarithm of what nobody measures is halved
constexpr std::chrono::seconds kStale{30}; // without a measurement
constexpr double kNothing = 0.01;          // logarithm of a factor that says nothing
// Part of the way from the middle to the upper bound: half of the errors are larger than the middle.
constexpr double kSafety = 0.25;

} // namespace

void Corrections::learn(uint32_t viewer, const std::string& method, const Ratio& measured, Time now) {
    const auto [one, is_new] = of_.try_emplace({viewer, method});
    Learnt& l = one->second;
    if (is_new) l.factor = factor(viewer, method), l.learnt = l.risen = now;
    const double passed = std::clamp(Seconds(now - l.learnt).count(), 0.0, 1.0);
    l.learnt = now;
    const double target = std::clamp(measured.middle + kSafety * (measured.high - measured.middle), kLeast, kMost);
    if (target > l.factor) {
        const bool certain = measured.low > l.factor;
        if (certain) {
            if (std::exchange(l.fallen, false)) l.wait = std::min(2 * l.wait, kLongestWait);
            l.risen = now;
        }
        l.factor *= certain ? target / l.factor : std::pow(target / l.factor, -std::expm1(-passed / kCreep));
    } else if (measured.high < l.factor && now - l.risen >= l.wait) {
        l.fallen = true;
        l.factor *= std::pow(target / l.factor, -std::expm1(-passed / kFall));
    }
}

void Corrections::fade(Time now) {
    for (auto& [of, l] : of_) {
        if (now - l.learnt <= kStale) continue;
        l.factor = std::pow(l.factor, std::exp2(-Seconds(now - l.learnt - kStale).count() / kFade));
        l.learnt = now - kStale;
    }
    std::erase_if(of_, [&](const auto& one) {
        return now - one.second.learnt >= kStale && std::abs(std::log(one.second.factor)) < kNothing;
    });
}

bool Corrections::knows(uint32_t viewer, std::string_view method) const {
    const auto one = of_.find({viewer, std::string(method)});
    return one != of_.end() && one->second.learnt != Time{};
}

double Corrections::factor(uint32_t viewer, std::string_view method) const {
    double largest = 0;
    for (const auto& [of, l] : of_) {
        if (of.second != method) continue;
        if (of.first == viewer && l.learnt != Time{}) return l.factor;
        if (of.first != viewer) largest = std::max(largest, l.factor);
    }
    return largest > 0 ? largest : 1;
}

} // namespace brume
