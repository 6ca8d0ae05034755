// A viewer of the audience for as long as this lives.
#pragma once

#include <functional>
#include <memory>

#include "server/net/metrics.h"

namespace brume::net {

class Seat {
public:
    // Null when the house is full. `audience` and `metrics` outlive the seat. The destructor waits for a running notify.
    static std::unique_ptr<Seat> take(Audience& audience, Metrics& metrics, std::function<void()> notify,
                                      uint32_t max_in_flight = 0, const std::string& key = {}) {
        auto viewer = audience.join(std::move(notify), max_in_flight, key);
        return viewer ? std::unique_ptr<Seat>(new Seat(audience, metrics, std::move(viewer))) : nullptr;
    }
    ~Seat() {
        audience_.leave(viewer_, lost_);
        settle();
    }
    Seat(const Seat&) = delete;
    Seat& operator=(const Seat&) = delete;

    Viewer& viewer() { return *viewer_; }
    // The connection was lost: the viewer may come back (Audience::join).
    void lose() { lost_ = true; }

    // Viewer::takeFrame(); superseded frames are counted on the way.
    FramePtr takeFrame() {
        settle();
        return viewer_->takeFrame();
    }

private:
    Seat(Audience& audience, Metrics& metrics, std::shared_ptr<Viewer> viewer)
        : audience_(audience), metrics_(metrics), viewer_(std::move(viewer)) {}

    void settle() {
        const uint64_t superseded = viewer_->counts().superseded;
        metrics_.superseded(superseded - superseded_);
        superseded_ = superseded;
    }

    Audience& audience_;
    Metrics& metrics_;
    std::shared_ptr<Viewer> viewer_;
    uint64_t superseded_ = 0; // already counted
    bool lost_ = false;
};

} // namespace brume::net
