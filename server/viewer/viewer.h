// One viewer, shared by its connection and the frame loop: holds the newest pose, the newest frame, and what is in
// flight.
#pragma once

#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "server/viewer/history.h"
#include "server/viewer/pacing.h"
#include "server/viewer/quality.h"

namespace brume {

// A camera that has stood still for so long rests.
inline constexpr std::chrono::milliseconds kRestsFor{150};

// How large a picture may be.
struct SizeLimit {
    double pixels = std::numeric_limits<double>::infinity(); // of all eyes together, at rest
    double side = 1;                                         // factor on the sides of one that moves
};

// Thread-safe: one connection and the frame loop hold the same object.
class Viewer {
public:
    // `notify` is called when takeFrame() would return a frame, or refusal() a reason; on the thread that delivers or
    // refuses. It may call takeFrame() but not close(). Two calls never overlap.
    Viewer(uint32_t id, const PacingOptions& pacing, std::function<void()> notify);

    uint32_t id() const { return id_; }

    // The key by which this viewer is found again after its connection broke (Audience::join).
    const std::string& key() const { return key_; }
    // True if it continues a viewer whose connection broke.
    bool resumed() const { return resumed_; }
    // Newcomer::owner.
    const std::string& owner() const { return owner_; }
    // Newcomer::token.
    const std::string& token() const { return token_; }
    // Newcomer::draws.
    bool draws() const { return draws_; }
    void known(std::string key, std::string owner, std::string token = {}, bool draws = false) {
        draws_ = draws;
        key_ = std::move(key);
        owner_ = std::move(owner);
        token_ = std::move(token);
    }
    // Continues with the pose of a broken connection. The next setPose() counts, however old its number is.
    void resume(const std::optional<PoseRequest>& pose);
    // Size, views, quality and format of what it asks for now are those of `granted`; the camera stays.
    void grant(const PoseRequest& granted);
    std::optional<PoseRequest> pose() const;

    // --- the connection's side ---
    // Sets the pose. Ignored if its seq is not newer than the present pose's (wrap-around safe).
    void setPose(const PoseRequest& request);
    // Sets the pose, however old its number is: the viewer's own again, after follow().
    void look(const PoseRequest& own);
    // Its pictures have the camera, size and view of person `leader`, who asks for `theirs`. All else stays as in its
    // pose, or as in `own`, a newer one. Nothing without a pose.
    void follow(uint32_t leader, const PoseRequest& theirs, const PoseRequest* own = nullptr);
    // Takes the newest frame; null when there is none. A frame that was replaced before it was taken counts as
    // superseded.
    FramePtr takeFrame(Clock::time_point now = Clock::now());
    // The viewer has presented frame `id` and, since frames are ordered, every one before it. False for an id not yet
    // sent.
    bool acknowledge(uint32_t frame_id, Clock::time_point now = Clock::now());
    // A ping came back: Pacing::ponged().
    void ponged(Clock::duration round_trip, Clock::time_point now, Pacing::Millis most_queue = Pacing::Millis::max());
    // Adapts the quality to the link; to be called several times a second. Returns how long sent frames have been
    // waiting for an acknowledgement. `backlog`: true if the socket had unsent bytes since the last call. Only then
    // do superseded frames count against the link.
    Clock::duration observe(Clock::time_point now, bool backlog = true);
    // The reason why the frame loop refuses this viewer; empty: it does not.
    std::string refusal() const;
    // Inputs that the simulation refused since the last call.
    struct RefusedInput {
        uint32_t seq;
        std::string why; // one line
    };
    std::vector<RefusedInput> takeRefusedInputs();
    // To be called when the connection has ended. Stops rendering and notifying; waits for a running notify.
    void close();

    // --- the frame loop's side ---
    // A frame that was handed out to be rendered.
    struct Due {
        uint32_t frame_id = 0;
        PoseRequest request;
        bool repeats = false; // True: an earlier frame answered this pose
        bool whole = false;   // of takeLit(). True: it will not be able to read changes
    };
    // The request that the next batch may draw; nothing: none is due. It notes that the window of bytes was full.
    // - Nothing is due without a pose, while the viewer's window is hidden, or while a window of frames or bytes is
    // full.
    // - Nothing is due when the picture would equal the last one: the view and `scene`, a version of all that is seen,
    //   are the same. Who shows a hidden window again gets one all the same. `scene` of nothing never is the same.
    // - `still_picture`: true asks for refinements of a picture at rest instead: JPEG of quality 90 or more after 150
    // ms,
    //   and PNG 150 ms later, over a link that does not queue. Each comes once. Who looks at errors gets more while
    //   something can be measured. Refinements have the size that was asked for, if `limit.pixels` allows it.
    // - `layers_last`: for so long a picture with layers shows the medium right. Until then nothing is due of one that
    //   the viewer can redraw: its camera has moved little. `part`: of both, below 1 for who may come early.
    std::optional<PoseRequest> pollDue(Clock::time_point now, std::optional<uint64_t> scene, bool still_picture,
                                       const SizeLimit& limit = {}, Clock::duration layers_last = {}, float part = 1);
    // What it asks for. Viewers with equal wishes have equal pictures, where their links allow it.
    struct Wish {
        uint32_t camera = 0;     // id of the viewer whose camera it has: its own, or whom it follows
        double pixels = 0;       // of all its eyes together; 0 while nothing is due to it, and for one_shot
        bool keeps_size = false; // True: it would rather have fewer pictures than smaller ones
        bool operator<(const Wish& other) const {
            return std::tie(camera, pixels, keeps_size) < std::tie(other.camera, other.pixels, other.keeps_size);
        }
    };
    Wish wish() const;
    // The request of a viewer whose pose is PoseRequest::one_shot, until its frame was handed out. pollDue() returns
    // nothing for such a viewer.
    std::optional<PoseRequest> pollOneShot();
    // Hands out a frame for a request that pollDue() or pollOneShot() returned. Nothing if the viewer has left or was
    // hidden meanwhile.
    std::optional<Due> take(const PoseRequest& due, Clock::time_point now, std::optional<uint64_t> scene);
    // Messages a second that it wants, who draws by itself; 0: it wants pictures, or nothing at present.
    uint32_t drawHz() const;
    // True: it draws by itself, was not sent this version of the scene, and its window has room.
    bool lags(uint64_t scene, Clock::time_point now) const;
    // Hands out a frame for message `number` of a medium that it draws by itself. `hz`: messages that are made a
    // second; `most_hz`: that it may have; infinite: it is due whatever its pace, unless it has this version of the
    // scene. Nothing: it is not due, since that is more than it wants or than its window allows.
    std::optional<Due> takeLit(uint32_t number, double hz, double most_hz, uint64_t scene, Clock::time_point now);
    // Sets the device's load for the next observe().
    void deviceHas(const DeviceLoad& load);
    uint32_t every() const; // least ticks between its frames
    // Delivers a frame that was handed out. It is dropped if a newer one has overtaken it; a superseded frame leaves
    // the window.
    void deliver(FramePtr frame);
    // No pixel of its last picture can be measured: who looks at errors gets no more of it at rest.
    void cannotMeasure();
    // A frame that was handed out could not be rendered: it leaves the window.
    void abandon(uint32_t frame_id);
    // This viewer's pictures cannot be drawn. Nothing is due any more, and its connection ends with this reason, one
    // line.
    void refuse(std::string reason);
    // An input of this viewer was taken, and changed nothing.
    void refuseInput(RefusedInput input);

    struct Counts {
        uint64_t rendered = 0, sent = 0, superseded = 0, acknowledged = 0;
        uint32_t in_flight = 0;
    };
    Counts counts() const;
    // State of its link.
    struct Link {
        float round_trip_ms = 0, queue_ms = 0; // round trip without queues; queueing delay
        uint32_t frames = 0;                   // window of frames
        size_t bytes_in_flight = 0;
        uint32_t level = 0, device_level = 0; // of QualityControl; 0: the best
        QualityStep step;
    };
    Link link() const;
    History history() const;

private:
    // Precondition of all: mutex_ is held.
    void place(const PoseRequest& request);
    QualityStep step() const;
    PoseRequest reducedBy(const QualityStep& step, double side) const; // the pose's
    // Of the pending frame, whose medium the viewer draws: what it can read. False: it can read none of it.
    bool chooseRows();
    // True: the viewer can redraw it from its last picture, within a part of what that tolerates.
    bool redraws(const PoseRequest& request, float part) const;

    const uint32_t id_;
    mutable std::mutex mutex_;
    std::mutex notify_mutex_;
    std::function<void()> notify_;
    std::string key_, owner_, token_;
    bool draws_ = false;
    bool resumed_ = false, any_pose_ = false; // any_pose_: true if the next pose counts, however old its number is
    std::optional<PoseRequest> pose_;
    FramePtr frame_;
    uint32_t issued_ = 0, sent_ = 0; // frame ids: the last handed out, the last taken by the connection
    Pacing pacing_;
    QualityControl quality_;
    enum class Detail { moving, still, lossless };
    std::optional<PoseRequest> made_;     // the last request handed out; still-picture refinements do not change it
    Clock::time_point made_at_{};         // when a frame was last handed out
    std::optional<uint64_t> scene_;       // its version of the scene
    Detail made_detail_ = Detail::moving; // its refinement
    LitHeld lit_held_;                    // that were sent
    std::optional<uint64_t> lit_scene_;   // version of the scene of the last of them
    uint32_t lit_every_ = 1;              // messages that its window has room for: every so many
    Clock::time_point lit_held_back_{};   // when the window last had no room for one
    float layers_reach_ = 0;              // m, that its eye may move with its last picture's layers; 0: it had none
    uint32_t layers_every_ = 1;           // least ticks between frames while it redraws them
    bool measurable_ = true;              // False: cannotMeasure() was called since it was made
    std::optional<DeviceLoad> device_;    // since the last observe()
    bool held_back_ = false;              // True: the window of bytes held a request back since then
    uint64_t superseded_seen_ = 0;        // Counts::superseded at the last observe()
    Counts counts_;
    History history_;
    std::string refusal_;
    static constexpr size_t kMostRefusedInputs = 256;
    std::vector<RefusedInput> refused_inputs_; // that the connection has not told yet; further ones are not told
    bool closed_ = false;                      // True: close() was called
};

} // namespace brume
