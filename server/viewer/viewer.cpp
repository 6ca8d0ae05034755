#include "server/viewer/viewer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/view_names.h"
#include "server/sim/simulation.h"

namespace brume {
namespace {

// A picture at rest is drawn again for who looks at its error: more of its pixels are measured.
constexpr std::chrono::milliseconds kMeasuresEvery{250};
constexpr uint8_t kShowsErrors = *viewNamed("error");
constexpr uint8_t kStillQuality = 90;
constexpr float kMeanWaitMs = 500.0f / 60; // mean time until a display's next frame

// How far an eye may move until its last picture's layers no longer show it well: parts of the depth of the medium and
// of the nearest surface. Within the first, layers of a cloud added no error (docs/results/layers.md). That was at the
// field of view of most scenes; a narrower one shows the same move larger.
constexpr float kMovedPart = 0.04f, kMovedBeside = 0.02f, kUsualTangent = 0.42f;
// How far it may turn, as a part of the tangent of half the field of view: pages ask for a margin of a tenth.
constexpr float kTurnedPart = 0.08f;

// Tangent of half the vertical field of view.
float tangentOf(const Pose& pose) {
    const Frustum& f = pose.frustum;
    return f.up + f.down > 0 ? 0.5f * (f.up + f.down) : std::tan(0.5f * pose.fov_y);
}

// m, that an eye may move until it needs another picture. 0: this one has no layers.
float reachOf(const EncodedFrame& frame) {
    float reach = 0;
    for (const LayersPtr& layers : frame.layers) {
        if (!layers) continue;
        const float medium = layers->count > 0 ? kMovedPart * std::sqrt(layers->near * layers->far) : 0;
        for (const float one : {medium, kMovedBeside * layers->nearest})
            if (one > 0) reach = reach > 0 ? std::min(reach, one) : one;
    }
    return reach;
}

std::chrono::duration<double> ticksLong(double ticks) { return std::chrono::duration<double>(ticks * kTickSeconds); }

} // namespace

double pixelsOf(const PoseRequest& request) { return double(request.width) * request.height * request.views; }

bool samePictures(const PoseRequest& a, const PoseRequest& b) {
    return a.pose.position == b.pose.position && a.pose.orientation == b.pose.orientation &&
           a.pose.fov_y == b.pose.fov_y && a.pose.eye_separation == b.pose.eye_separation &&
           a.pose.frustum == b.pose.frustum && a.pose.right_frustum == b.pose.right_frustum && a.width == b.width &&
           a.height == b.height && a.views == b.views && a.quality == b.quality && a.still_picture == b.still_picture &&
           a.lossless == b.lossless && a.one_shot == b.one_shot && a.show == b.show && a.layers == b.layers &&
           a.alpha == b.alpha;
}

Viewer::Viewer(uint32_t id, const PacingOptions& pacing, std::function<void()> notify)
    : id_(id), notify_(std::move(notify)), pacing_(pacing) {}

void Viewer::setPose(const PoseRequest& request) {
    const std::scoped_lock lock(mutex_);
    if (pose_ && !any_pose_ && !isNewer(request.seq, pose_->seq)) return;
    place(request);
}

void Viewer::look(const PoseRequest& own) {
    const std::scoped_lock lock(mutex_);
    place(own);
}

void Viewer::follow(uint32_t leader, const PoseRequest& theirs, const PoseRequest* own) {
    const std::scoped_lock lock(mutex_);
    if (!own && !pose_) return;
    PoseRequest request = own ? *own : *pose_;
    request.pose = theirs.pose;
    request.width = theirs.width, request.height = theirs.height;
    if (theirs.views > request.views) request.pose.right_frustum = {}, request.pose.eye_separation = 0;
    request.show = theirs.show;
    request.layers = theirs.layers;
    request.follows = leader;
    request.received = theirs.received;
    place(request);
}

void Viewer::place(const PoseRequest& request) {
    if (closed_) return;
    any_pose_ = false;
    if (pose_ && pose_->hidden && !request.hidden) made_.reset(); // its picture is due, though it may show nothing new
    const bool rests = pose_ && samePictures(*pose_, request);
    const Clock::time_point since = rests ? pose_->since : request.received;
    pose_ = request;
    pose_->since = since;
    if (pose_->hidden) pacing_.clear(); // a hidden window presents nothing: no acknowledgement is missing
}

void Viewer::resume(const std::optional<PoseRequest>& pose) {
    const std::scoped_lock lock(mutex_);
    resumed_ = any_pose_ = true;
    pose_ = pose;
    if (pose_) pose_->received = Clock::now(), pose_->follows = 0;
}

void Viewer::grant(const PoseRequest& granted) {
    const std::scoped_lock lock(mutex_);
    if (!pose_) return;
    PoseRequest request = granted;
    request.seq = pose_->seq;
    request.client_time_us = pose_->client_time_us;
    request.pose = pose_->pose;
    request.show = pose_->show;
    request.received = request.since = pose_->received;
    pose_ = request;
}

std::optional<PoseRequest> Viewer::pose() const {
    const std::scoped_lock lock(mutex_);
    return pose_;
}

FramePtr Viewer::takeFrame(Clock::time_point now) {
    const std::scoped_lock lock(mutex_);
    if (!frame_ || (frame_->lit && !chooseRows())) return nullptr;
    sent_ = frame_->id;
    ++counts_.sent;
    size_t bytes = 0;
    frame_->eachPart([&](std::span<const uint8_t> part) { bytes += part.size(); });
    const float queue_ms = std::chrono::duration<float, std::milli>(now - frame_->encoded).count();
    pacing_.sent(frame_->id, bytes, frame_->render_ms + frame_->encode_ms + queue_ms + kMeanWaitMs, now);
    const float wait_ms = frame_->repeats ? History::kUnknown : frame_->wait_ms;
    history_.add({wait_ms, frame_->render_ms, frame_->encode_ms, queue_ms, frame_->gpu_ms}, now);
    return std::move(frame_);
}

bool Viewer::acknowledge(uint32_t frame_id, Clock::time_point now) {
    const std::scoped_lock lock(mutex_);
    if (frame_id == 0 || counts_.sent == 0 || isNewer(frame_id, sent_)) return false;
    counts_.acknowledged += pacing_.acknowledged(frame_id, now);
    return true;
}

void Viewer::ponged(Clock::duration round_trip, Clock::time_point now, Pacing::Millis most_queue) {
    const std::scoped_lock lock(mutex_);
    pacing_.ponged(round_trip, now, most_queue);
}

Clock::duration Viewer::observe(Clock::time_point now, bool backlog) {
    const std::scoped_lock lock(mutex_);
    const uint32_t level = quality_.level();
    quality_.observe(
        {pacing_.queueMs(), held_back_, backlog && counts_.superseded > superseded_seen_, std::exchange(device_, {})},
        now);
    if (quality_.level() < level) pacing_.probe();
    held_back_ = false;
    superseded_seen_ = counts_.superseded;
    return pacing_.silence(now);
}

void Viewer::close() {
    {
        const std::scoped_lock lock(mutex_);
        closed_ = true;
        frame_.reset();
        pacing_.clear();
    }
    const std::scoped_lock lock(notify_mutex_); // waits until a running notify_ returns
    notify_ = nullptr;
}

Viewer::Wish Viewer::wish() const {
    const std::scoped_lock lock(mutex_);
    if (closed_ || !pose_ || pose_->hidden || pose_->one_shot || !refusal_.empty()) return {};
    return {pose_->follows ? pose_->follows : id_, pixelsOf(*pose_), pose_->keeps_size};
}

std::optional<PoseRequest> Viewer::pollDue(Clock::time_point now, std::optional<uint64_t> scene, bool still_picture,
                                           const SizeLimit& limit, Clock::duration layers_last, float part) {
    const std::scoped_lock lock(mutex_);
    if (closed_ || !pose_ || pose_->hidden || pose_->one_shot || !refusal_.empty()) return {};
    const QualityStep step = this->step();
    PoseRequest request = reducedBy(step, limit.side);
    const PoseRequest whole = reducedBy(quality_.linkStep(pose_->keeps_size), limit.side); // as the link alone has it
    request.reduced = limit.side < 1 ? Reduced::device : quality_.reduced();
    if (made_ && scene && scene == scene_ && (samePictures(*made_, request) || samePictures(*made_, whole))) {
        // PNG is large: over a link that has queued, the next pose's picture would wait behind it.
        const bool lossless =
            made_detail_ == Detail::still && request.takes_png && request.show != kShowsErrors && !pacing_.bytes();
        const bool collects = request.show == kShowsErrors && measurable_ && now - made_at_ >= kMeasuresEvery;
        if (!still_picture || (made_detail_ != Detail::moving && !lossless && !collects)) return {};
        if (quality_.level() > 0 || now - made_at_ < kRestsFor) return {};
        if (pixelsOf(whole) <= limit.pixels) request = whole;
        if (pixelsOf(request) < pixelsOf(*made_)) request.width = made_->width, request.height = made_->height;
        request.reduced = request.width < pose_->width ? Reduced::device : Reduced::no;
        request.still_picture = true;
        request.lossless = lossless;
        request.quality = std::max(request.quality, kStillQuality);
    } else if (still_picture) {
        return {};
    }
    if (!pacing_.isOpen(now)) {
        held_back_ = held_back_ || pacing_.isHeldByBytes();
        return {};
    }
    layers_every_ = 1;
    if (!still_picture && layers_last > Clock::duration{} && redraws(request, part)) {
        if (now - made_at_ < layers_last * double(part)) return {};
        layers_every_ = uint32_t(layers_last / ticksLong(1));
    }
    if (!still_picture && step.every > 1 && now - made_at_ < ticksLong(step.every - 0.5)) return {};
    return request;
}

bool Viewer::redraws(const PoseRequest& request, float part) const {
    if (!made_ || layers_reach_ == 0) return false;
    const Pose &made = made_->pose, &wanted = request.pose;
    PoseRequest there = request;
    there.pose.position = made.position, there.pose.orientation = made.orientation;
    const float half = tangentOf(wanted);
    const glm::quat turn = glm::inverse(made.orientation) * wanted.orientation;
    const float angle = 2 * std::asin(std::min(glm::length(glm::vec3(turn.x, turn.y, turn.z)), 1.0f));
    return samePictures(*made_, there) && angle < part * kTurnedPart * half / (1 + half * half) &&
           glm::distance(made.position, wanted.position) < part * layers_reach_ * std::min(half / kUsualTangent, 1.0f);
}

PoseRequest Viewer::reducedBy(const QualityStep& step, double side) const {
    PoseRequest request = *pose_;
    request.quality = std::min(request.quality, step.quality);
    if (step.half) side = std::min(side, 0.5);
    request.width = uint16_t(std::max(request.width * side, 1.0));
    request.height = uint16_t(std::max(request.height * side, 1.0));
    return request;
}

std::optional<PoseRequest> Viewer::pollOneShot() {
    const std::scoped_lock lock(mutex_);
    if (closed_ || !pose_ || !pose_->one_shot || made_ || !refusal_.empty()) return {};
    PoseRequest request = *pose_;
    request.still_picture = true;
    return request;
}

std::optional<Viewer::Due> Viewer::take(const PoseRequest& request, Clock::time_point now,
                                        std::optional<uint64_t> scene) {
    const std::scoped_lock lock(mutex_);
    if (closed_ || (pose_ && pose_->hidden)) return {};
    const bool repeats = made_ && made_->seq == request.seq;
    if (++issued_ == 0) ++issued_; // 0 is no frame
    pacing_.issued(issued_, now);
    made_detail_ = request.lossless ? Detail::lossless : request.still_picture ? Detail::still : Detail::moving;
    made_at_ = now;
    if (!request.still_picture) measurable_ = true;
    if (!request.still_picture || request.one_shot)
        made_ = request;
    else if (made_)
        made_->width = request.width, made_->height = request.height;
    scene_ = scene;
    return Due{issued_, request, repeats};
}

void Viewer::deliver(FramePtr frame) {
    {
        const std::scoped_lock lock(mutex_);
        if (closed_) return;
        ++counts_.rendered;
        // Frames may leave the encoders out of order. A frame that is older than one here or sent is dropped.
        const bool overtaken =
            (counts_.sent > 0 && !isNewer(frame->id, sent_)) || (frame_ && !isNewer(frame->id, frame_->id));
        if (overtaken || frame_) {
            pacing_.dropped(overtaken ? frame->id : frame_->id);
            ++counts_.superseded;
        }
        if (overtaken) return;
        layers_reach_ = reachOf(*frame);
        frame_ = std::move(frame);
    }
    const std::scoped_lock lock(notify_mutex_);
    if (notify_) notify_();
}

void Viewer::cannotMeasure() {
    const std::scoped_lock lock(mutex_);
    measurable_ = false;
}

void Viewer::abandon(uint32_t frame_id) {
    const std::scoped_lock lock(mutex_);
    pacing_.dropped(frame_id);
    made_.reset(); // its frame was not made: the same view is due again
    lit_scene_.reset();
    made_detail_ = Detail::moving;
}

void Viewer::refuse(std::string reason) {
    {
        const std::scoped_lock lock(mutex_);
        refusal_ = std::move(reason);
    }
    const std::scoped_lock lock(notify_mutex_);
    if (notify_) notify_();
}

std::string Viewer::refusal() const {
    const std::scoped_lock lock(mutex_);
    return refusal_;
}

void Viewer::refuseInput(RefusedInput input) {
    {
        const std::scoped_lock lock(mutex_);
        if (refused_inputs_.size() == kMostRefusedInputs) return;
        refused_inputs_.push_back(std::move(input));
    }
    const std::scoped_lock lock(notify_mutex_);
    if (notify_) notify_();
}

std::vector<Viewer::RefusedInput> Viewer::takeRefusedInputs() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(refused_inputs_, {});
}

Viewer::Counts Viewer::counts() const {
    const std::scoped_lock lock(mutex_);
    Counts counts = counts_;
    counts.in_flight = pacing_.inFlight();
    return counts;
}

void Viewer::deviceHas(const DeviceLoad& load) {
    const std::scoped_lock lock(mutex_);
    device_ = load;
}

QualityStep Viewer::step() const { return quality_.step(pose_ && pose_->keeps_size); }

uint32_t Viewer::every() const {
    const std::scoped_lock lock(mutex_);
    return std::max<uint32_t>(step().every, layers_every_);
}

History Viewer::history() const {
    const std::scoped_lock lock(mutex_);
    return history_;
}

Viewer::Link Viewer::link() const {
    const std::scoped_lock lock(mutex_);
    return {pacing_.baseRoundTripMs(),
            pacing_.queueMs(),
            pacing_.frames(),
            pacing_.bytesInFlight(),
            quality_.level(),
            quality_.deviceLevel(),
            step()};
}

} // namespace brume
