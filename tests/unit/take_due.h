// takeDue(): polls a viewer for its due request and takes it at once. The server chooses among all viewers between
// these two steps; tests of one viewer do not need that. Also poses, windows and frames of such tests.
#pragma once

#include "server/viewer/viewer.h"

namespace brume {

inline std::optional<Viewer::Due> takeDue(Viewer& viewer, Clock::time_point now = Clock::now(),
                                          std::optional<uint64_t> scene = {}, bool still_picture = false) {
    auto request = viewer.pollDue(now, scene, still_picture);
    if (!request) request = viewer.pollOneShot();
    return request ? viewer.take(*request, now, scene) : std::nullopt;
}

inline PoseRequest poseWithSeq(uint32_t seq) {
    PoseRequest request;
    request.seq = seq;
    return request;
}

inline PacingOptions windowOf(uint32_t frames) { return {.least_frames = frames, .most_frames = frames}; }

inline FramePtr frameFor(const Viewer::Due& due, Clock::time_point encoded = Clock::now()) {
    auto frame = std::make_shared<EncodedFrame>();
    frame->encoded = encoded;
    frame->id = due.frame_id;
    frame->request = due.request;
    return frame;
}

} // namespace brume
