// Which viewers' pictures the next submission draws. It knows viewers, their turns and the frame budget; it has no
// clock and no device, so that fairness and overload are tested by themselves.
#pragma once

#include <limits>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "server/inputs/eye_request.h"
#include "server/plan/work.h"
#include "server/viewer/schedule.h"
#include "server/viewer/viewer.h"

namespace brume {

// One viewer's pictures in a batch.
struct BatchJob {
    std::shared_ptr<Viewer> viewer;
    Viewer::Due due;
    uint32_t pictures = 0;  // number of the first job with the same pictures: that one draws and encodes them
    uint32_t first_eye = 0; // of the pictures, in Batch's eyes
    float gpu_ms = 0;       // the device's time for this viewer, measured
    MeasuredError measured; // of this viewer's pictures by the batch's method
};

// What one submission draws.
struct BatchContents {
    std::vector<BatchJob> jobs;
    std::vector<EyeRequest> eyes; // of the jobs that draw, each once
    // Every distinct picture that was due in the last second, in this batch or not: what the plan is made for.
    std::vector<PlanView> views;
    // True: redraws views that have not changed for 150 ms, with less error and full colour.
    bool still_pictures = false;
    bool one_shot = false;      // True: one picture of PoseRequest::one_shot; it says nothing about the viewers' load
    uint32_t seat = 0;          // of a one-shot picture: the number by which the schedule knows its owner
    float full_batch_ratio = 1; // predicted time of a batch with all due viewers / of this batch; at least 1
};

// Pixels of a picture for which a newcomer must find time, and below which no wish is made smaller.
inline constexpr double kLeastPixels = 160 * 90;

class BatchPlanner {
public:
    struct Limits {
        double budget_ms = 0;                                     // that a batch may take
        double most_ms = std::numeric_limits<double>::infinity(); // that one with the pictures of all viewers may take
        double ms_per_pixel = 0;                                  // predicted, until pictures were measured
        double still_ratio = 1;               // predicted time of a still picture / of the same while it moves
        bool still = true;                    // False: still pictures wait
        bool full = false;                    // True: all pictures have full colour, also those that move
        std::span<const uint32_t> deferred{}; // ids of viewers whose one-shot pictures wait
        Clock::duration layers_last{};        // so long a picture with layers shows the medium right
        uint64_t bytes = ~0ull;               // of a batch's pictures; a viewer that exceeds them alone is drawn alone
    };
    // Takes the due viewers that the budget allows. `scene`: a version of all that is seen. When nothing has changed
    // for anybody, still pictures are taken. Pictures that are too large for `most_ms` are made smaller, the largest
    // first. One-shot pictures are drawn alone; all of one owner share one viewer's part of the time. False when nobody
    // is due.
    bool plan(std::span<const std::shared_ptr<Viewer>> viewers, uint64_t scene, const Limits& limits,
              Clock::time_point now, BatchContents& out);

    // Of the last plan(). True: every due viewer is in the batch at full quality, and no camera has moved for 150 ms.
    bool camerasRest(Clock::time_point now) const;
    // ms of the device, predicted, for a batch with all due viewers.
    double fullBatchMs() const { return schedule_.fullBatchMs(); }

    // Measured, in ms of the device: what the batch's viewers share, and each job's own.
    // - `besides`: a factor on that, for the loop and the driver.
    // - `usual`: true if pictures had the usual error. Finer ones took no less time than usual ones.
    void took(const BatchContents& batch, double shared_ms, double besides, bool usual);

    // What the device has to do for this viewer, and for how many it does.
    double predictMs(uint32_t viewer) const { return schedule_.predictPart(viewer); }
    // Schedule::someoneWaits().
    bool someoneWaits() const { return schedule_.someoneWaits(); }
    // Viewers for whom there is time within `most_ms` if each has a picture of `pixels`; nothing is known: infinite.
    double viewersInTime(double pixels, double most_ms) const { return schedule_.viewersInTime(pixels, most_ms); }
    uint32_t activeViewers() const { return std::max(schedule_.active(), 1u); }

private:
    static constexpr uint32_t kFirstSeat = 1u << 31; // viewers' ids count up from 1

    void limitSizes(std::span<const std::shared_ptr<Viewer>> viewers, double most_ms, bool still);
    void findOneShots(std::span<const std::shared_ptr<Viewer>> viewers, std::span<const uint32_t> deferred);
    void takeOneShot(std::span<const std::shared_ptr<Viewer>> viewers, const PoseRequest& request, uint64_t scene,
                     Clock::time_point now, BatchContents& out);
    void findDue(std::span<const std::shared_ptr<Viewer>> viewers, uint64_t scene, const Limits& limits, bool still,
                 Clock::time_point now);
    void addDue(const std::shared_ptr<Viewer>& viewer, const PoseRequest& due, bool full);
    void takeAlong(std::span<const std::shared_ptr<Viewer>> viewers, uint64_t scene, const Limits& limits,
                   Clock::time_point now);
    uint32_t seatOf(const std::string& owner);
    void keepRecent(size_t watched, Clock::time_point now);
    void add(const std::shared_ptr<Viewer>& viewer, const Viewer::Due& due, BatchContents& out) const;

    Schedule schedule_;
    // Numbers by which the schedule knows owners whose one-shot pictures wait. Each has a viewer's turn.
    std::map<std::string, uint32_t> seats_;
    uint32_t next_seat_ = kFirstSeat;
    // Pictures that viewers with equal wishes share.
    struct Shared {
        uint32_t viewers = 0; // how many wish for them
        double ms = 0;        // predicted time of the device
        SizeLimit limit;
    };
    std::map<Viewer::Wish, Shared> shared_;
    std::vector<Shared*> shared_of_;           // by viewer: its entry there
    std::vector<double> demands_;              // by viewer: its part of what its pictures take, ms
    std::vector<uint32_t> present_;            // ids in the schedule
    std::vector<std::shared_ptr<Viewer>> due_; // viewers of the requests in the next two lists
    std::vector<PoseRequest> requests_;
    std::vector<Schedule::DrawRequest> draw_requests_;
    // The newest request of each viewer for whom one was due in the last second.
    struct Recent {
        uint32_t viewer;
        Clock::time_point at;
        PoseRequest request;
    };
    std::vector<Recent> recent_;
};

} // namespace brume
