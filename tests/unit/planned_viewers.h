// Viewers of a batch planner under test, and a link that brings them all that was drawn.
#pragma once

#include <gtest/gtest.h>

#include "server/loop/batch_planner.h"

namespace brume::test {

inline const Clock::time_point kStart = Clock::time_point{} + std::chrono::hours(1);

inline std::shared_ptr<Viewer> viewerOf(uint32_t id) { return std::make_shared<Viewer>(id, PacingOptions{}, nullptr); }

inline PoseRequest poseOf(uint32_t seq, uint16_t width, uint16_t height, float x = 0, uint8_t views = 1) {
    PoseRequest request;
    request.seq = seq;
    request.pose.position.x = x;
    request.width = width;
    request.height = height;
    request.views = views;
    request.received = kStart;
    return request;
}

// Its frames reach the viewer, who acknowledges them.
inline void deliver(const BatchContents& batch, Clock::time_point now) {
    for (const BatchJob& job : batch.jobs) {
        auto frame = std::make_shared<EncodedFrame>();
        frame->id = job.due.frame_id;
        frame->request = job.due.request;
        frame->encoded = now;
        job.viewer->deliver(std::move(frame));
        ASSERT_TRUE(job.viewer->takeFrame(now));
        ASSERT_TRUE(job.viewer->acknowledge(job.due.frame_id, now));
    }
}

} // namespace brume::test
