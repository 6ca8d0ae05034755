// One viewer as the frame loop and its connection both see it: newest pose in, newest frame out, and what is in flight.
#pragma once

#include <functional>
#include <mutex>
#include <optional>

#include "server/viewer/frame.h"

namespace brume {

// Thread-safe: one connection and the frame loop hold the same object.
class Viewer {
public:
    // `notify` is called, from any thread and without a lock held, when takeFrame() would return a frame.
    Viewer(uint32_t id, uint32_t max_in_flight, std::function<void()> notify);

    uint32_t id() const { return id_; }

    // --- the connection's side ---
    // Newest pose in: an older or equal seq than the one held is ignored (wrap-around safe).
    void setPose(const PoseRequest& request);
    // Newest frame out; null when there is none. A frame that was replaced before it was taken counts as superseded.
    FramePtr takeFrame();
    // The viewer has presented frame `id` and, since frames are ordered, every one before it. False for an id never sent.
    bool acknowledge(uint32_t frame_id);
    // The connection is gone: nothing is rendered for it and nothing is notified any more (after close() returns).
    void close();

    // --- the frame loop's side ---
    // The pose to render now, counting a frame in flight, with its id; nothing while the window is full or no pose came.
    struct Due {
        uint32_t frame_id;
        PoseRequest request;
    };
    std::optional<Due> takeDue();
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
    uint32_t issued_ = 0, settled_ = 0; // frame ids: the last handed out, the last acknowledged or given up
    Counts counts_;
    bool closed_ = false;
};

} // namespace brume
