#include "server/loop/batch_planner.h"

#include <algorithm>

#include "server/encode/depth_layers.h"
#include "server/loop/tick_source.h"

namespace brume {
namespace {

constexpr uint32_t kMostEyes = 64; // of a submission; viewers beyond that are first in the next one
constexpr size_t kMostSeats = 256;
constexpr auto kRecent = std::chrono::seconds(1);

// Pixels that a picture's time is paid for. A small one takes as long as one of kLeastPixels: its passes cost that.
double paidPixels(double pixels) { return pixels > 0 ? std::max(pixels, kLeastPixels) : 0; }
double paidPixels(const PoseRequest& request) { return paidPixels(pixelsOf(request)); }

// The factor on the sides of a picture of which only a part of the pixels may be drawn. It grows only where there is a
// quarter to spare, so that sizes do not swing.
double fittedSide(double part, double before) {
    constexpr double kSteps[] = {1, 0.75, 0.5, 0.375, 0.25, 0.1875, 0.125};
    for (const double side : kSteps)
        if (side * side * (side > before ? 1.25 : 1) <= part) return side;
    return kSteps[std::size(kSteps) - 1];
}

} // namespace

// Limits pictures so that a frame of all viewers takes no more than `most_ms`. Of those who keep the size one picture
// alone takes no more: it is drawn more seldom. `still`: true for pictures at rest, false for those that move.
void BatchPlanner::limitSizes(std::span<const std::shared_ptr<Viewer>> viewers, double most_ms, bool still) {
    shared_of_.clear();
    demands_.clear();
    for (auto& [wish, shared] : shared_) shared.viewers = 0, shared.ms = 0;
    for (const std::shared_ptr<Viewer>& viewer : viewers) {
        const Viewer::Wish wish = viewer->wish();
        Shared& shared = *shared_of_.emplace_back(&shared_[wish]);
        ++shared.viewers;
        shared.ms = std::max(shared.ms, schedule_.predict(viewer->id(), paidPixels(wish.pixels)));
    }
    std::erase_if(shared_, [](const auto& one) { return one.second.viewers == 0; });
    for (const Shared* shared : shared_of_) demands_.push_back(shared->ms / shared->viewers);
    const double whole = schedule_.forPictures(most_ms), level = fairLevel(demands_, whole);
    for (auto& [wish, shared] : shared_) {
        const double most = wish.keeps_size ? whole : level * shared.viewers;
        shared.limit.pixels = shared.ms > most ? std::max(wish.pixels * most / shared.ms, kLeastPixels)
                                               : std::numeric_limits<double>::infinity();
        if (!still) shared.limit.side = fittedSide(shared.limit.pixels / wish.pixels, shared.limit.side);
    }
}

void BatchPlanner::findDue(std::span<const std::shared_ptr<Viewer>> viewers, uint64_t scene, const Limits& limits,
                           bool still, Clock::time_point now) {
    due_.clear();
    requests_.clear();
    draw_requests_.clear();
    for (size_t i = 0; i < viewers.size(); ++i)
        if (const auto due = viewers[i]->pollDue(now, scene, still, shared_of_[i]->limit, limits.layers_last))
            addDue(viewers[i], *due, limits.full || still);
}

void BatchPlanner::addDue(const std::shared_ptr<Viewer>& viewer, const PoseRequest& due, bool full) {
    const auto same = std::find_if(requests_.begin(), requests_.end(),
                                   [&](const PoseRequest& request) { return samePictures(request, due); });
    const PlaneLayout layout{due.width, due.height, full};
    draw_requests_.push_back(
        {.viewer = viewer->id(),
         .pixels = paidPixels(due),
         .eyes = due.views,
         .bytes = (layout.bytes() + depthLayerBytes(due.width, due.height, due.layers)) * due.views,
         .every = viewer->every(),
         .like = uint32_t(same - requests_.begin())});
    requests_.push_back(due);
    due_.push_back(viewer);
}

// Viewers who redraw their pictures and need new ones soon come along, as many as the budget has time for: many
// pictures of one batch take less time. Any two then come together sooner or later.
void BatchPlanner::takeAlong(std::span<const std::shared_ptr<Viewer>> viewers, uint64_t scene, const Limits& limits,
                             Clock::time_point now) {
    if (due_.empty() || limits.layers_last == Clock::duration{}) return;
    size_t known = 0; // viewers who are due anyway come in the order of all
    const size_t due_anyway = due_.size();
    double ms = 0;
    for (uint32_t i = 0; i < draw_requests_.size(); ++i)
        if (const Schedule::DrawRequest& one = draw_requests_[i]; one.like == i)
            ms += schedule_.predict(one.viewer, one.pixels);
    for (size_t i = 0; i < viewers.size(); ++i) {
        if (known < due_anyway && due_[known] == viewers[i]) {
            ++known;
            continue;
        }
        const auto due = viewers[i]->pollDue(now, scene, false, shared_of_[i]->limit, limits.layers_last, 0.5f);
        if (!due) continue;
        if (std::ranges::none_of(requests_, [&](const PoseRequest& other) { return samePictures(other, *due); }))
            ms += schedule_.predict(viewers[i]->id(), paidPixels(*due));
        if (ms > limits.budget_ms) return;
        addDue(viewers[i], *due, limits.full);
    }
}

uint32_t BatchPlanner::seatOf(const std::string& owner) {
    const auto [seat, is_new] = seats_.try_emplace(owner, next_seat_);
    if (is_new) next_seat_ = std::max(next_seat_ + 1, kFirstSeat);
    return seat->second;
}

// Of every owner the one that has waited longest.
void BatchPlanner::findOneShots(std::span<const std::shared_ptr<Viewer>> viewers, std::span<const uint32_t> deferred) {
    const size_t first = requests_.size();
    if (seats_.size() > kMostSeats) seats_.clear();
    for (const std::shared_ptr<Viewer>& viewer : viewers) {
        const auto request = viewer->pollOneShot();
        if (!request || std::ranges::find(deferred, viewer->id()) != deferred.end()) continue;
        const uint32_t seat = seatOf(viewer->owner());
        size_t at = first;
        while (at < requests_.size() && draw_requests_[at].viewer != seat) ++at;
        if (at == requests_.size()) {
            draw_requests_.push_back({.viewer = seat, .like = uint32_t(at), .alone = true});
            requests_.push_back(*request);
            due_.push_back(viewer);
        } else if (request->received < requests_[at].received) {
            requests_[at] = *request;
        }
        draw_requests_[at].pixels = paidPixels(requests_[at]);
        draw_requests_[at].eyes = requests_[at].views;
    }
}

// `watched`: how many of the requests are of viewers. Precondition: present_ is up to date.
void BatchPlanner::keepRecent(size_t watched, Clock::time_point now) {
    for (size_t i = 0; i < watched; ++i) {
        const uint32_t viewer = draw_requests_[i].viewer;
        const auto at = std::ranges::find(recent_, viewer, &Recent::viewer);
        if (at == recent_.end())
            recent_.push_back({viewer, now, requests_[i]});
        else
            *at = {viewer, now, requests_[i]};
    }
    std::erase_if(recent_, [&](const Recent& one) {
        return now - one.at > kRecent || !std::ranges::binary_search(present_, one.viewer);
    });
}

bool BatchPlanner::plan(std::span<const std::shared_ptr<Viewer>> viewers, uint64_t scene, const Limits& limits,
                        Clock::time_point now, BatchContents& out) {
    out.jobs.clear();
    out.eyes.clear();
    out.views.clear();
    out.still_pictures = out.one_shot = false;
    out.full_batch_ratio = 1;
    schedule_.expect(limits.ms_per_pixel);
    limitSizes(viewers, limits.most_ms, false);
    findDue(viewers, scene, limits, false, now);
    takeAlong(viewers, scene, limits, now);
    if (draw_requests_.empty() && limits.still) { // no viewer's picture has changed
        out.still_pictures = true;
        limitSizes(viewers, limits.most_ms / std::max(1.0, limits.still_ratio), true);
        findDue(viewers, scene, limits, true, now);
    }
    const size_t watched = requests_.size();
    findOneShots(viewers, limits.deferred);
    if (draw_requests_.empty()) return false;

    present_.clear();
    for (const std::shared_ptr<Viewer>& viewer : viewers) present_.push_back(viewer->id());
    for (const auto& [owner, seat] : seats_) present_.push_back(seat);
    std::ranges::sort(present_);
    schedule_.stay(present_);
    keepRecent(watched, now);
    const double dearer = out.still_pictures ? limits.still_ratio : 1;
    for (const uint32_t number :
         schedule_.choose(draw_requests_, {limits.budget_ms, dearer, kMostEyes, limits.bytes}, now, kTick)) {
        if (draw_requests_[number].alone)
            takeOneShot(viewers, requests_[number], scene, now, out), out.seat = draw_requests_[number].viewer;
        else if (const auto due = due_[number]->take(requests_[number], now, scene))
            add(due_[number], *due, out);
    }
    due_.clear();
    requests_.resize(watched);
    if (out.one_shot) return !out.jobs.empty();
    for (auto one = recent_.begin(); one != recent_.end(); ++one) {
        const PoseRequest& request = one->request;
        if (std::any_of(recent_.begin(), one, [&](const Recent& o) { return samePictures(o.request, request); }))
            continue;
        for (int eye = 0; eye < request.views; ++eye)
            out.views.push_back(
                {eyePose(request.pose, eye, request.views), request.width, request.height, one->viewer});
    }
    // Who looks at how a picture is made costs more time. Accuracy is not given up for that.
    const bool shows = std::ranges::any_of(requests_, [](const PoseRequest& r) { return r.show != gpu::kShowPicture; });
    if (!shows && schedule_.chosenMs() > 0)
        out.full_batch_ratio = float(schedule_.fullBatchMs() / schedule_.chosenMs());
    return !out.jobs.empty();
}

// For all who ask for the same picture.
void BatchPlanner::takeOneShot(std::span<const std::shared_ptr<Viewer>> viewers, const PoseRequest& wanted,
                               uint64_t scene, Clock::time_point now, BatchContents& out) {
    for (const std::shared_ptr<Viewer>& viewer : viewers)
        if (const auto request = viewer->pollOneShot(); request && samePictures(*request, wanted))
            if (const auto due = viewer->take(*request, now, scene)) add(viewer, *due, out);
    for (EyeRequest& eye : out.eyes) {
        eye.history = 0; // it is the same for everyone who asks
        out.views.push_back({eye.pose, eye.width, eye.height});
    }
    out.one_shot = out.still_pictures = true;
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
        out.eyes.push_back({.pose = eyePose(request.pose, eye, request.views),
                            .width = request.width,
                            .height = request.height,
                            .second = eye == 1,
                            .history = 2 * uint64_t(viewer->id()) + uint64_t(eye) + 1,
                            .depth_layers = request.layers,
                            .show = request.show});
}

bool BatchPlanner::camerasRest(Clock::time_point now) const {
    return schedule_.chosenMs() > 0.999 * schedule_.fullBatchMs() &&
           std::all_of(requests_.begin(), requests_.end(),
                       [&](const PoseRequest& r) { return r.reduced == Reduced::no && now - r.since >= kRestsFor; });
}

void BatchPlanner::took(const BatchContents& batch, double shared_ms, double besides, bool usual) {
    if (batch.one_shot) {
        const BatchJob& drawn = batch.jobs.front();
        return schedule_.took(batch.seat, paidPixels(drawn.due.request), besides * (shared_ms + double(drawn.gpu_ms)),
                              false);
    }
    schedule_.sharedTook(besides * shared_ms);
    for (const BatchJob& job : batch.jobs) {
        const uint32_t viewer = job.viewer->id();
        const double pixels = paidPixels(job.due.request), ms = besides * double(job.gpu_ms);
        if (usual)
            schedule_.took(viewer, pixels, ms, job.due.request.show == gpu::kShowPicture);
        else
            schedule_.finerTook(viewer, pixels, ms);
    }
}

} // namespace brume
