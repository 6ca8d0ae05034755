// One viewer as the frame loop and its connection both see it: newest pose in, newest frame out, and what is in flight.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <vector>

#include "server/viewer/frame.h"

namespace brume {

// Thread-safe: one connection and the frame loop hold the same object.
class Viewer {
public:
    // `notify` is called from the thread that delivers when takeFrame() would return a frame. It may call takeFrame() but not
    // close(), and runs once at a time.
    Viewer(uint32_t id, uint32_t max_in_flight, std::function<void()> notify);

    uint32_t id() const { return id_; }

    // --- the connection's side ---
    // Newest pose in: an older or equal seq than the one held is ignored (wrap-around safe).
    void setPose(const PoseRequest& request);
    // Newest frame out; null when there is none. A frame that was replaced before it was taken counts as superseded.
    FramePtr takeFrame();
    // The viewer has presented frame `id` and, since frames are ordered, every one before it. False for an id not yet sent.
    bool acknowledge(uint32_t frame_id);
    // The connection is gone: nothing is rendered for it and nothing is notified any more. Waits for a running notify.
    void close();

    // --- the frame loop's side ---
    // The pose to render now, counting a frame in flight, with its id; nothing while the window is full or no pose came.
    struct Due {
        uint32_t frame_id = 0;
        PoseRequest request;
    };
    std::optional<Due> takeDue();
    // A due frame, ready. One that a newer frame has overtaken is dropped; either way superseded frames free their place.
    void deliver(FramePtr frame);
    // A due frame that could not be rendered: gives its place in the window back.
    void abandon(uint32_t frame_id);

    struct Counts {
        uint64_t rendered = 0, sent = 0, superseded = 0, acknowledged = 0;
        uint32_t in_flight = 0;
    };
    Counts counts() const;

private:
    const uint32_t id_;
    const uint32_t max_in_flight_;
    mutable std::mutex mutex_;
    std::mutex notify_mutex_;
    std::function<void()> notify_;
    std::optional<PoseRequest> pose_;
    FramePtr frame_;
    uint32_t issued_ = 0, sent_ = 0;  // frame ids: the last handed out, the last taken by the connection
    std::vector<uint32_t> in_flight_; // ids handed out and not yet acknowledged, superseded or abandoned
    Counts counts_;
    bool closed_ = false;
};

} // namespace brume
