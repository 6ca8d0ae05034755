#include "server/viewer/viewer.h"

#include <algorithm>

namespace brume {
namespace {

// Serial numbers that wrap around: `a` is newer when less than half the range ahead.
bool isNewer(uint32_t a, uint32_t b) { return int32_t(a - b) > 0; }

} // namespace

bool samePictures(const PoseRequest& a, const PoseRequest& b) {
    return a.pose.position == b.pose.position && a.pose.orientation == b.pose.orientation && a.pose.fov_y == b.pose.fov_y &&
           a.pose.eye_separation == b.pose.eye_separation && a.pose.frustum == b.pose.frustum &&
           a.pose.right_frustum == b.pose.right_frustum && a.width == b.width && a.height == b.height && a.views == b.views &&
           a.quality == b.quality;
}

Viewer::Viewer(uint32_t id, uint32_t max_in_flight, std::function<void()> notify)
    : id_(id), max_in_flight_(std::max(max_in_flight, 1u)), notify_(std::move(notify)) {
    in_flight_.reserve(max_in_flight_);
}

void Viewer::setPose(const PoseRequest& request) {
    const std::scoped_lock lock(mutex_);
    if (closed_ || (pose_ && !isNewer(request.seq, pose_->seq))) return;
    pose_ = request;
}

FramePtr Viewer::takeFrame() {
    const std::scoped_lock lock(mutex_);
    if (!frame_) return nullptr;
    sent_ = frame_->id;
    ++counts_.sent;
    return std::move(frame_);
}

bool Viewer::acknowledge(uint32_t frame_id) {
    const std::scoped_lock lock(mutex_);
    if (frame_id == 0 || counts_.sent == 0 || isNewer(frame_id, sent_)) return false;
    counts_.acknowledged += std::erase_if(in_flight_, [&](uint32_t id) { return !isNewer(id, frame_id); });
    return true;
}

void Viewer::close() {
    {
        const std::scoped_lock lock(mutex_);
        closed_ = true;
        frame_.reset();
        in_flight_.clear();
    }
    const std::scoped_lock lock(notify_mutex_); // waits for a running notify
    notify_ = nullptr;
}

std::optional<Viewer::Due> Viewer::takeDue() {
    const std::scoped_lock lock(mutex_);
    if (closed_ || !pose_ || in_flight_.size() >= max_in_flight_) return {};
    if (++issued_ == 0) ++issued_; // 0 is no frame
    in_flight_.push_back(issued_);
    return Due{issued_, *pose_};
}

void Viewer::deliver(FramePtr frame) {
    {
        const std::scoped_lock lock(mutex_);
        if (closed_) return;
        ++counts_.rendered;
        // Frames may leave the encoder out of order: one that a newer frame has overtaken is of no use.
        const bool overtaken = (counts_.sent > 0 && !isNewer(frame->id, sent_)) || (frame_ && !isNewer(frame->id, frame_->id));
        if (overtaken || frame_) {
            std::erase(in_flight_, overtaken ? frame->id : frame_->id);
            ++counts_.superseded;
        }
        if (overtaken) return;
        frame_ = std::move(frame);
    }
    const std::scoped_lock lock(notify_mutex_);
    if (notify_) notify_();
}

void Viewer::abandon(uint32_t frame_id) {
    const std::scoped_lock lock(mutex_);
    std::erase(in_flight_, frame_id);
}

Viewer::Counts Viewer::counts() const {
    const std::scoped_lock lock(mutex_);
    Counts counts = counts_;
    counts.in_flight = uint32_t(in_flight_.size());
    return counts;
}

} // namespace brume
