// What the frame loop tells viewers besides frames, and who watches the server.
#include <algorithm>

#include "server/frame.h"
#include "server/gpu/pipeline_cache.h"
#include "server/loop/scene_report.h"
#include "server/plan/list_prices.h"

namespace brume {

// Those who asked for what cannot be.
void FrameLoop::tellRefused() {
    audience_.list(viewers_);
    for (const RefusedCommand& refused : simulation_.refused())
        for (const auto& viewer : viewers_)
            if (viewer->id() == refused.viewer) viewer->refuseInput({refused.seq, refused.why});
    viewers_.clear();
}

// Viewers are told of what is new about ticks besides their number. `sought`: TickSource::seeks() before the last ones.
void FrameLoop::followTicks(bool sought) {
    if (paused_ != ticks_->paused() || sought != ticks_->seeks() || standstill_ != ticks_->standstill())
        changed_ = true;
    if (serves_ != ticks_->serves()) audience_.ready = serves_ = !serves_;
}

void FrameLoop::tellLoad(Clock::time_point now) {
    load_told_ = now;
    audience_.list(viewers_);
    drawn_viewers_.clear();
    for (const auto& viewer : viewers_) drawn_viewers_.push_back(viewer->id());
    std::ranges::sort(drawn_viewers_);
    meter_.stay(drawn_viewers_);
    readMeter(now);
    for (const auto& viewer : viewers_)
        viewer->deviceHas({batch_planner_.predictMs(viewer->id()), most_full_ms_, frame_ms_,
                           batch_planner_.activeViewers(), planner_->exhausted()});
    viewers_.clear();
    audience_.setRoom(uint32_t(std::clamp(batch_planner_.roomFor(kLeastPixels, most_frame_ms_), 1.0, 1e9)));
    priceLists();
    metrics_.budget(most_full_ms_ / frame_ms_);
    audience_.budget_used = float(most_full_ms_ / frame_ms_);
    most_full_ms_ = on_device_ ? batch_planner_.fullBatchMs() : 0; // of the batch that goes on
}

// A picture of the scene's own view may take four times --most-frame-time, since pictures get smaller then, or half as
// long again as one of a dear scene did before anybody added a light.
void FrameLoop::priceLists() {
    const bool known = priced_ == simulation_.listsHash() && !audience_.commands().isPricedOut();
    if (planner_->plan().passes.empty() || known) return;
    constexpr double kDearer = 1.5, kSmaller = 4;
    priced_ = simulation_.listsHash();
    const PlanScene scene = planScene(scene_, simulation_);
    const auto prices = [&](double most) {
        return listPrices(scene, planner_->plan().chosen.settings, ownView(scene_), planner_->costs().model(), most);
    };
    constexpr double kAll = 1e12;
    if (list_ms_ == 0) list_ms_ = std::max(kSmaller * most_frame_ms_, kDearer * (kAll - prices(kAll).left));
    audience_.commands().price(prices(list_ms_));
}

void FrameLoop::report(Clock::time_point now) {
    reported_ = now;
    changed_ = false;
    const std::shared_ptr<SceneReport> report = sceneReport(simulation_, planner_->plan());
    if (ticks_) {
        if (paused_ != ticks_->paused()) ++pauses_;
        paused_ = ticks_->paused();
        if (paused_) tellPaused(*report, *paused_, pauses_);
        standstill_ = ticks_->standstill();
        if (standstill_) report->standstill = standstill_;
    }
    report->preparing = audience_.preparing();
    report->passes = ledger_.passes();
    report->errors = errors_;
    const LightWork& work = renderer_->lightWork();
    report->light = {work.voxel_rays, work.froxel_rays, work.places};
    report->memory = {device_.memoryInUse(), device_.peakMemory(), simulation_.bytes() + renderer_->particleBytes()};
    metrics_.kept(pictureBytes(), device_.pipelines().size());
    audience_.publish(report);
}

} // namespace brume
