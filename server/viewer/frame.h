// What travels between the frame loop and a viewer's connection: the pose that is wanted, the frame that answers it.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "common/camera.h"

namespace brume {

using Clock = std::chrono::steady_clock;

struct PoseRequest {
    uint32_t seq = 0;
    uint64_t client_time_us = 0;
    Pose pose;
    uint16_t width = 640, height = 360; // of one eye
    uint8_t views = 1;                  // 1 or 2
    uint8_t quality = 80;               // JPEG, 1...100
    bool lowered = false;               // its quality: below what the viewer wishes for
    bool hidden = false;                // true: the viewer's window is not seen; nothing is due until a pose without it
    bool takes_png = false;             // the viewer: what rests may come without loss
    bool fine = false;                  // of what rests: with less error than what moves, and all of its colour
    bool lossless = false;              // of a fine one: as PNG
    Clock::time_point received{};
    Clock::time_point since{}; // the same view was first asked for; the viewer's to fill
};

// Bytes of one picture, JPEG or PNG; frames of viewers that ask for the same picture share them.
using Jpeg = std::shared_ptr<const std::vector<uint8_t>>;

// One encoded answer to one pose; immutable once delivered. JPEG bytes stay in `jpeg` until the socket has sent them.
struct EncodedFrame {
    uint32_t id = 0; // grows by one per viewer
    uint64_t tick = 0, state_hash = 0;
    PoseRequest request;
    bool again = false; // not the first of its pose: how long that waited says nothing of the server
    float wait_ms = 0, render_ms = 0, encode_ms = 0, gpu_ms = 0;
    Clock::time_point encoded{};
    std::array<Jpeg, 2> jpeg; // [request.views]
    bool png = false;         // all of them are
};
// Whether both ask for the same pictures, however they are numbered.
bool samePictures(const PoseRequest& a, const PoseRequest& b);

using FramePtr = std::shared_ptr<const EncodedFrame>;

struct PassTime {
    std::string name;
    float ms = 0; // smoothed
};

} // namespace brume
