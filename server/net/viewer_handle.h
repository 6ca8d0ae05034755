// A viewer of the audience for as long as this object lives.
#pragma once

#include <functional>
#include <memory>

#include "server/metrics/metrics.h"

namespace brume::net {

class ViewerHandle {
public:
    struct Admission {
        std::unique_ptr<ViewerHandle> handle; // null: refused
        const char* refusal;                  // one line
    };
    // As Audience::join(). `audience` and `metrics` outlive the handle. `notify` is called when a frame is ready; the
    // destructor waits for a call that runs.
    static Admission join(Audience& audience, Metrics& metrics, std::function<void()> notify,
                          const Newcomer& newcomer) {
        auto [viewer, refusal] = audience.join(std::move(notify), newcomer);
        if (!viewer) return {nullptr, refusal};
        return {std::unique_ptr<ViewerHandle>(new ViewerHandle(audience, metrics, std::move(viewer))), ""};
    }
    ~ViewerHandle() {
        audience_.leave(viewer_, lost_);
        countSuperseded();
    }
    ViewerHandle(const ViewerHandle&) = delete;
    ViewerHandle& operator=(const ViewerHandle&) = delete;

    Viewer& viewer() { return *viewer_; }
    // The connection was lost: the viewer may come back (Audience::join).
    void markLost() { lost_ = true; }

    // Viewer::takeFrame(). Frames that were superseded since the last call are counted.
    FramePtr takeFrame() {
        countSuperseded();
        return viewer_->takeFrame();
    }

private:
    ViewerHandle(Audience& audience, Metrics& metrics, std::shared_ptr<Viewer> viewer)
        : audience_(audience), metrics_(metrics), viewer_(std::move(viewer)) {}

    void countSuperseded() {
        const uint64_t superseded = viewer_->counts().superseded;
        metrics_.superseded(superseded - superseded_);
        superseded_ = superseded;
    }

    Audience& audience_;
    Metrics& metrics_;
    std::shared_ptr<Viewer> viewer_;
    uint64_t superseded_ = 0; // already counted
    bool lost_ = false;       // true: the viewer may come back
};

} // namespace brume::net
