#include "server/loop/batch_planner.h"

#include <algorithm>

#include "server/loop/tick_source.h"
#include "server/render/picture.h"

namespace brume {
namespace {

constexpr uint32_t kMostEyes = 64; // of a submission; viewers beyond that are first in the next one
constexpr auto kRestsFor = std::chrono::milliseconds(150);

double pixelsOf(const PoseRequest& request) { return double(request.width) * request.height * request.views; }

} // namespace

void BatchPlanner::findDue(std::span<const std::shared_ptr<Viewer>> viewers, uint64_t scene, bool still,
                           Clock::time_point now) {
    due_.clear();
    requests_.clear();
    draw_requests_.clear();
    for (const std::shared_ptr<Viewer>& viewer : viewers) {
        const auto due = viewer->pollDue(now, scene, still);
        if (!due) continue;
        const auto same = std::find_if(requests_.begin(), requests_.end(),
                                       [&](const PoseRequest& request) { return samePictures(request, *due); });
        const PlaneLayout layout{due->width, due->height, still};
        draw_requests_.push_back({.viewer = viewer->id(),
                                  .pixels = pixelsOf(*due),
                                  .eyes = due->views,
                                  .bytes = layout.bytes() * due->views,
                                  .every = viewer->every(),
                                  .like = uint32_t(same - requests_.begin())});
        requests_.push_back(*due);
        due_.push_back(viewer);
    }
}

bool BatchPlanner::plan(std::span<const std::shared_ptr<Viewer>> viewers, uint64_t scene, const Limits& limits,
                        Clock::time_point now, BatchContents& out) {
    out.jobs.clear();
    out.eyes.clear();
    out.views.clear();
    out.still_pictures = out.one_shot = false;
    if (!one_shot_last_ && planOneShot(viewers, scene, now, out)) return one_shot_last_ = true;
    one_shot_last_ = false;
    findDue(viewers, scene, false, now);
    if (draw_requests_.empty()) { // no viewer's picture has changed
        out.still_pictures = true;
        findDue(viewers, scene, true, now);
    }
    if (draw_requests_.empty()) return one_shot_last_ = planOneShot(viewers, scene, now, out);
    const double dearer = out.still_pictures ? limits.still_ratio : 1;
    for (const uint32_t number :
         schedule_.choose(draw_requests_, {limits.budget_ms, dearer, kMostEyes, limits.bytes}, now, kTick))
        if (const auto due = due_[number]->take(requests_[number], now, scene)) add(due_[number], *due, out);
    due_.clear();
    for (size_t i = 0; i < draw_requests_.size(); ++i)
        for (int eye = 0; draw_requests_[i].like == i && eye < requests_[i].views; ++eye)
            out.views.push_back(
                {eyePose(requests_[i].pose, eye, requests_[i].views), requests_[i].width, requests_[i].height});
    out.full_batch_ratio = schedule_.chosenMs() > 0 ? float(schedule_.fullBatchMs() / schedule_.chosenMs()) : 1;
    return !out.jobs.empty();
}

// The one that has waited longest, for all who ask for the same picture.
bool BatchPlanner::planOneShot(std::span<const std::shared_ptr<Viewer>> viewers, uint64_t scene, Clock::time_point now,
                               BatchContents& out) {
    std::optional<PoseRequest> first;
    for (const std::shared_ptr<Viewer>& viewer : viewers)
        if (const auto request = viewer->pollOneShot(); request && (!first || request->received < first->received))
            first = request;
    if (!first) return false;
    for (const std::shared_ptr<Viewer>& viewer : viewers)
        if (const auto request = viewer->pollOneShot(); request && samePictures(*request, *first))
            if (const auto due = viewer->take(*request, now, scene)) add(viewer, *due, out);
    for (const EyeRequest& eye : out.eyes) out.views.push_back({eye.pose, eye.width, eye.height});
    out.full_batch_ratio = 1;
    out.one_shot = out.still_pictures = !out.jobs.empty();
    return out.one_shot;
}

// Viewers that ask for the same pictures share them.
void BatchPlanner::add(const std::shared_ptr<Viewer>& viewer, const Viewer::Due& due, BatchContents& out) const {
    const auto same = std::find_if(out.jobs.begin(), out.jobs.end(),
                                   [&](const BatchJob& job) { return samePictures(job.due.request, due.request); });
    if (same != out.jobs.end()) {
        out.jobs.push_back({viewer, due, same->pictures, same->first_eye});
        return;
    }
    out.jobs.push_back({viewer, due, uint32_t(out.jobs.size()), uint32_t(out.eyes.size())});
    const PoseRequest& request = due.request;
    for (int eye = 0; eye < request.views; ++eye)
        out.eyes.push_back({eyePose(request.pose, eye, request.views), request.width, request.height, eye == 1});
}

bool BatchPlanner::camerasRest(Clock::time_point now) const {
    return schedule_.chosenMs() > 0.999 * schedule_.fullBatchMs() &&
           std::all_of(requests_.begin(), requests_.end(),
                       [&](const PoseRequest& r) { return !r.lowered && now - r.since >= kRestsFor; });
}

void BatchPlanner::took(const BatchContents& batch, double shared_ms, double besides, bool usual) {
    schedule_.sharedTook(besides * shared_ms);
    if (!usual) return;
    for (const BatchJob& job : batch.jobs)
        schedule_.took(job.viewer->id(), pixelsOf(job.due.request), besides * double(job.gpu_ms));
}

} // namespace brume
