#include "server/frame/planning.h"

#include <algorithm>

#include "server/plan/list_prices.h"

namespace brume {
namespace {

constexpr int kPlansPause = 8; // times as long as the last plan took

} // namespace

Planning::Planning(ShownScene& shown, ReadyWays& ways, const FrameOptions& options)
    : shown_(shown), ways_(ways), costs_(options.costs), most_frame_ms_(options.most_frame_ms),
      planner_(std::in_place, *shown.scene, options.costs, options.frame_ms, &ways) {}

void Planning::showScene(double frame_ms) {
    planner_.emplace(*shown_.scene, costs_, frame_ms, &ways_);
    priced_.reset();
    list_ms_ = 0;
    renew_ = true;
}

const RenderSettings& Planning::settings(std::span<const PlanView> views, Time now) {
    const bool anew = renew_ || (asked_ && now >= next_asked_);
    const Time begin = Time::clock::now();
    const RenderSettings& planned = planner_->settings(shown_.simulation, views, anew, now);
    drawn_before_ = asked_ && !anew;
    if (anew) {
        renew_ = asked_ = false;
        const Time end = Time::clock::now();
        next_asked_ = end + kPlansPause * (end - begin);
    }
    return planned;
}

// A picture of the scene's own view may take four times --most-frame-time, since pictures get smaller then, or half as
// long again as one of a dear scene did before anybody added a light.
void Planning::priceLists(CommandQueue& commands) {
    const bool known = priced_ == shown_.simulation.listsHash() && !commands.isPricedOut();
    if (planner_->plan().passes.empty() || known) return;
    constexpr double kDearer = 1.5, kSmaller = 4;
    priced_ = shown_.simulation.listsHash();
    const PlanScene scene = planScene(*shown_.scene, shown_.simulation);
    const auto prices = [&](double most) {
        return listPrices(scene, planner_->plan().chosen.settings, ownView(*shown_.scene), planner_->costs().model(),
                          most);
    };
    constexpr double kAll = 1e12;
    if (list_ms_ == 0) list_ms_ = std::max(kSmaller * most_frame_ms_, kDearer * (kAll - prices(kAll).left));
    commands.price(prices(list_ms_));
}

} // namespace brume
