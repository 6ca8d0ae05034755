// CostLearning: corrects the cost model by the times that passes took, each by its own. Passes that did not run yet are
// scaled as the others are on average: a machine is faster or slower in all.
#pragma once

#include <array>
#include <span>

#include "server/plan/cost_model.h"
#include "server/plan/work.h"

namespace brume {

// Time of one pass of a submission, ms.
struct PassMs {
    std::string_view name;
    double ms = 0;
};

class CostLearning {
public:
    // What is learnt is at most so many times as dear as built in or as calibrated, and at most so many times as cheap:
    // no machine is much slower than a CPU that draws, and GPUs are much faster.
    static constexpr double kMostDear = 30, kMostCheap = 10'000;

    explicit CostLearning(CostModel model);

    // `work`: of the submission that took these times. Its passes that are not in `passes` did not run. A pass may come
    // several times. `disturbed`: true if other work may have made the times longer: only what is cheaper than
    // predicted even so is learnt.
    void learn(const Work& work, std::span<const PassMs> passes, bool disturbed = false);
    const CostModel& model() const { return now_; }
    // The model before anything was learnt.
    const CostModel& first() const { return first_; }
    // True: enough was learnt for others to use it.
    bool isKnown() const { return lessons_ >= kKnown; }

private:
    static constexpr uint32_t kQuick = 8, kKnown = 30; // submissions

    const CostModel first_, base_; // base_: what the bounds count from
    CostModel now_;
    std::array<uint32_t, kMostCosts> seen_{}; // by cost: submissions that had it
    uint32_t lessons_ = 0;
};

} // namespace brume
