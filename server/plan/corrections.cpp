#include "server/plan/corrections.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "server/error/accuracy.h"

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

void Corrections::learn(uint32_t viewer, const std::string& method, double law, const Ratio& measured, Time now) {
    const double expected = factor(viewer, method, law);
    OfMethod& known = of_[{viewer, method}];
    const bool is_first = known.empty();
    const auto [one, is_new] = known.try_emplace(accuracyOf(law));
    Learnt& l = one->second;
    if (is_new) l.factor = expected, l.learnt = l.risen = now;
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
    } else if (is_new && !is_first) { // the factor so far, of another accuracy, was a guess
        l.factor = target;
    } else if (measured.high < l.factor && now - l.risen >= l.wait) {
        l.fallen = true;
        l.factor *= std::pow(target / l.factor, -std::expm1(-passed / kFall));
    }
}

void Corrections::fade(Time now) {
    for (auto& [of, known] : of_) {
        for (auto& [accuracy, l] : known) {
            if (now - l.learnt <= kStale) continue;
            const double half = std::max(kFade, Seconds(l.wait).count());
            l.factor = std::pow(l.factor, std::exp2(-Seconds(now - l.learnt - kStale).count() / half));
            l.fallen = l.fallen || l.factor > 1;
            l.learnt = now - kStale;
        }
        std::erase_if(known, [&](const auto& one) {
            return now - one.second.learnt >= kStale && std::abs(std::log(one.second.factor)) < kNothing;
        });
    }
    std::erase_if(of_, [](const auto& one) { return one.second.empty(); });
}

double Corrections::largest(uint32_t viewer) const {
    double most = 0;
    for (auto of = of_.lower_bound({viewer, {}}); of != of_.end() && of->first.first == viewer; ++of)
        for (const auto& [accuracy, learnt] : of->second) most = std::max(most, learnt.factor);
    return most > 0 ? most : 1;
}

bool Corrections::knows(uint32_t viewer, std::string_view method) const {
    return of_.contains({viewer, std::string(method)});
}

double Corrections::between(const OfMethod& known, double law) {
    const double accuracy = exactAccuracyOf(law);
    const auto above = known.lower_bound(int(std::ceil(accuracy)));
    if (above == known.end()) return std::prev(above)->second.factor;
    if (above == known.begin()) return above->second.factor;
    const auto below = std::prev(above);
    const double part = (accuracy - below->first) / (above->first - below->first);
    return below->second.factor * std::pow(above->second.factor / below->second.factor, part);
}

double Corrections::factor(uint32_t viewer, std::string_view method, double law) const {
    double largest = 0;
    for (const auto& [of, known] : of_) {
        if (of.second != method) continue;
        const double one = between(known, law);
        if (of.first == viewer) return one;
        largest = std::max(largest, one);
    }
    return largest > 0 ? largest : 1;
}

} // namespace brume
