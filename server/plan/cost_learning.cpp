#include "server/plan/cost_learning.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace brume {
namespace {

constexpr double kStep = 0.5, kSmallStep = 0.05; // part of a cost's error that a submission mends: at first; later
constexpr double kLeastMs = 0.05;                // shorter submissions are mostly the driver's own work
constexpr double kLeastPassMs = 0.3, kLeastPassMsOfGpu = 0.01;

// True: `name` is the cost's pass, or one of those that it counts together ("cull, sort").
bool isOf(std::string_view name, const CostInfo& cost) {
    for (std::string_view rest = cost.pass; !rest.empty();) {
        const size_t end = std::min(rest.find(", "), rest.size());
        if (rest.substr(0, end) == name) return true;
        rest.remove_prefix(std::min(end + 2, rest.size()));
    }
    return false;
}

} // namespace

CostLearning::CostLearning(CostModel model)
    : first_(std::move(model)), base_(first_.calibrated && !first_.learnt ? first_ : builtInCosts()), now_(first_) {}

void CostLearning::learn(const Work& work, std::span<const PassMs> passes, bool disturbed) {
    std::array<double, kMostCosts> measured{}, predicted{};
    double all = 0;
    for (size_t i = 0; i < allCosts().size(); ++i) predicted[i] = work[i] * now_.ns[i] * 1e-6;
    for (const PassMs& pass : passes) {
        double sum = 0; // predicted time of the costs that the pass counts: they share its time in that proportion
        for (const CostInfo* cost : allCosts())
            if (isOf(pass.name, *cost)) sum += predicted[numberOf(*cost)];
        if (!(sum > 0)) continue;
        all += pass.ms;
        // A pass of little work takes the time that every pass takes: no price of its work.
        if (std::max(pass.ms, sum) < (first_.on_cpu ? kLeastPassMs : kLeastPassMsOfGpu)) continue;
        for (const CostInfo* cost : allCosts())
            if (isOf(pass.name, *cost)) measured[numberOf(*cost)] += pass.ms * predicted[numberOf(*cost)] / sum;
    }
    if (!(all > kLeastMs)) return;
    for (size_t i = 0; i < allCosts().size(); ++i) {
        if (!(measured[i] > 0) || (disturbed && measured[i] >= predicted[i])) continue;
        const double part = seen_[i]++ < kQuick ? kStep : kSmallStep;
        now_.ns[i] = std::clamp(now_.ns[i] * std::pow(measured[i] / predicted[i], part), base_.ns[i] / kMostCheap,
                                base_.ns[i] * kMostDear);
    }
    lessons_ += !disturbed;
    double sum = 0, count = 0;
    for (size_t i = 0; i < allCosts().size(); ++i)
        if (seen_[i] > 0) sum += std::log(now_.ns[i] / first_.ns[i]), ++count;
    if (!(count > 0)) return;
    for (size_t i = 0; i < allCosts().size(); ++i)
        if (seen_[i] == 0) now_.ns[i] = first_.ns[i] * std::exp(sum / count);
}

} // namespace brume
