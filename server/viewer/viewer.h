// One viewer as the frame loop and its connection both see it: newest pose in, newest frame out, and what is in flight.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>

#include "server/viewer/history.h"
#include "server/viewer/pacing.h"
#include "server/viewer/quality.h"

namespace brume {

// Thread-safe: one connection and the frame loop hold the same object.
class Viewer {
public:
    // `notify` is called from the thread that delivers when takeFrame() would return a frame. It may call takeFrame() but not
    // close(), and runs once at a time.
    Viewer(uint32_t id, const PacingOptions& pacing, std::function<void()> notify);

    uint32_t id() const { return id_; }

    // What a lost connection is known by (Audience::join), and whether this one goes on from such.
    const std::string& key() const { return key_; }
    bool resumed() const { return resumed_; }
    void known(std::string key) { key_ = std::move(key); }
    // Goes on with the pose of a lost connection, until any pose comes.
    void resume(const std::optional<PoseRequest>& pose);
    std::optional<PoseRequest> pose() const;

    // --- the connection's side ---
    // Newest pose in: an older or equal seq than the one held is ignored (wrap-around safe).
    void setPose(const PoseRequest& request);
    // Frames also of what has not changed: for those who take a stream that pauses for a broken one.
    void drawAlways();
    // Newest frame out; null when there is none. A frame that was replaced before it was taken counts as superseded.
    FramePtr takeFrame(Clock::time_point now = Clock::now());
    // The viewer has presented frame `id` and, since frames are ordered, every one before it. False for an id not yet sent.
    bool acknowledge(uint32_t frame_id, Clock::time_point now = Clock::now());
    // The round trip of a ping to it, as Pacing::ponged.
    void ponged(Clock::duration round_trip, Clock::time_point now, Pacing::Millis most_queue = Pacing::Millis::max());
    // To be called several times a second: what its link can carry follows what it did. How long frames have been waiting for an
    // acknowledgement. `backlog`: since the last look there were bytes that the link had not taken; without, frames that were
    // replaced say nothing of it.
    Clock::duration observe(Clock::time_point now, bool backlog = true);
    // Why the frame loop refuses it; empty while it does not.
    std::string refusal() const;
    // The connection is gone: nothing is rendered for it and nothing is notified any more. Waits for a running notify.
    void close();

    // --- the frame loop's side ---
    // The pose to render now, counting a frame in flight, with its id. Nothing is due while no pose came, the newest pose says
    // that the viewer's window is hidden, a window of frames or bytes is full, or the picture would be the one made last: same
    // view, same `scene` (a version of all that is seen; none: always another).
    struct Due {
        uint32_t frame_id = 0;
        PoseRequest request;
        bool again = false; // frames of this pose were handed out before
    };
    // The request that the next batch may draw. To be called once for each batch, since each call counts: it skips frames as
    // QualityStep::every says, and it notes when the window of bytes alone held a request back.
    // `fine`: once, the picture that has rested for 150 ms, at JPEG quality 90 or more; 150 ms later, once, without loss, for a
    // viewer that takes PNG and whose link does not queue; nothing else.
    std::optional<PoseRequest> pollDue(Clock::time_point now, std::optional<uint64_t> scene, bool fine);
    // Hands out a frame for a request that pollDue() returned. Nothing if the viewer has left or was hidden meanwhile.
    std::optional<Due> take(const PoseRequest& due, Clock::time_point now, std::optional<uint64_t> scene);
    // What the device has to do now, for the next look().
    void deviceHas(const DeviceLoad& load);
    uint32_t every() const; // ticks between its frames, at least
    // A due frame, ready. One that a newer frame has overtaken is dropped; either way superseded frames free their place.
    void deliver(FramePtr frame);
    // A due frame that could not be rendered: gives its place in the window back.
    void abandon(uint32_t frame_id);
    // Its pictures cannot be drawn: nothing is due any more, and its connection is to end with this reason, one line.
    void refuse(std::string reason);

    struct Counts {
        uint64_t rendered = 0, sent = 0, superseded = 0, acknowledged = 0;
        uint32_t in_flight = 0;
    };
    Counts counts() const;
    // What its link is and gets.
    struct Link {
        float round_trip_ms = 0, queue_ms = 0; // without queues, and what they add
        uint32_t frames = 0;                   // window
        size_t bytes_in_flight = 0;
        uint32_t level = 0, device_level = 0; // of QualityControl, 0 the best
        QualityStep step;
    };
    Link link() const;
    History history() const;

private:
    const uint32_t id_;
    mutable std::mutex mutex_;
    std::mutex notify_mutex_;
    std::function<void()> notify_;
    std::string key_;
    bool resumed_ = false, any_pose_ = false; // any_pose_: the next one counts, however old its number is
    std::optional<PoseRequest> pose_;
    FramePtr frame_;
    uint32_t issued_ = 0, sent_ = 0; // frame ids: the last handed out, the last taken by the connection
    Pacing pacing_;
    QualityControl quality_;
    enum class Detail { moving, fine, lossless };
    std::optional<PoseRequest> made_;     // what was handed out last, but for finer ones of the same,
    Clock::time_point made_at_{};         // when the last of them was,
    std::optional<uint64_t> scene_;       // of which scene
    Detail made_detail_ = Detail::moving; // and how fine it was
    uint32_t skipped_ = 0;                // of those that QualityStep::every counts
    bool always_ = false;                 // drawAlways()
    std::optional<DeviceLoad> device_;    // since the last look
    bool held_back_ = false;              // by the window of bytes, since the last look
    uint64_t superseded_seen_ = 0;        // by the last look
    Counts counts_;
    History history_;
    std::string refusal_;
    bool closed_ = false; // True: close() was called
};

} // namespace brume
