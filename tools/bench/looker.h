// Looker: a viewer without a network, who asks for pictures and keeps none.
#pragma once

#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "server/viewer/audience.h"

namespace brume::bench {

class Looker {
public:
    // `width`, `height`: pixels. Precondition: the audience has room.
    Looker(Audience& audience, uint16_t width, uint16_t height)
        : audience_(audience), viewer_(audience
                                           .join([this] {
                                               const std::scoped_lock lock(mutex_);
                                               told_ = true;
                                               changed_.notify_all();
                                           })
                                           .viewer),
          width_(width), height_(height) {}

    ~Looker() { audience_.leave(viewer_); }
    Looker(const Looker&) = delete;
    Looker& operator=(const Looker&) = delete;

    // Asks for a picture. `seq`: larger than that of the last pose. `once`: true for a snapshot.
    void look(uint32_t seq, const Pose& pose, bool once = false) {
        PoseRequest request;
        request.seq = seq;
        request.pose = pose;
        request.one_shot = once;
        request.width = width_;
        request.height = height_;
        request.received = Clock::now();
        viewer_->setPose(request);
    }
    // The next frame; null when the viewer is refused first, or nothing happens for half a minute.
    FramePtr next() {
        std::unique_lock lock(mutex_);
        while (changed_.wait_for(lock, std::chrono::seconds(30), [&] { return told_; })) {
            told_ = false;
            if (FramePtr frame = viewer_->takeFrame()) {
                viewer_->acknowledge(frame->id);
                return frame;
            }
            if (!viewer_->refusal().empty()) return nullptr;
        }
        return nullptr;
    }
    std::string refusal() const { return viewer_->refusal(); }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    bool told_ = false; // True: something came since the last look
    Audience& audience_;
    const std::shared_ptr<Viewer> viewer_;
    const uint16_t width_, height_;
};

} // namespace brume::bench
