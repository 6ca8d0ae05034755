// PoseRequest and EncodedFrame: a viewer's connection passes a pose to the frame loop and gets the frame that answers
// it.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/camera.h"
#include "server/viewer/lit_tick.h"

namespace brume {

using Clock = std::chrono::steady_clock;

// Of serial numbers that wrap around: true if `a` is less than half the range ahead of `b`.
constexpr bool isNewer(uint32_t a, uint32_t b) { return int32_t(a - b) > 0; }

// Why pictures are less than what was asked for. The values are wire::Reduced's.
enum class Reduced : uint8_t { no, link, device };

// A one-shot picture whose sky is left out: with straight colours as shown (PNG), or with linear radiance times alpha
// (EXR).
enum class Alpha : uint8_t { none, png, exr };

// A request for the pictures of one viewer at one pose.
struct PoseRequest {
    uint32_t seq = 0;
    uint64_t client_time_us = 0;
    Pose pose;
    uint16_t width = 640, height = 360; // pixels of one eye's picture
    uint8_t views = 1;                  // eyes: 1 or 2
    uint8_t quality = 80;               // JPEG, 1...100
    Reduced reduced = Reduced::no;      // why quality, size or rate is below what the viewer asked for
    bool hidden = false;                // True: the viewer's window is hidden. Nothing is drawn until it shows again
    bool takes_png = false;             // True: the viewer accepts PNG for still pictures
    bool keeps_size = false;            // True: the viewer would rather have fewer pictures than smaller ones
    bool still_picture = false;         // True: redraws a view at rest, with less error and full colour (4:4:4)
    bool lossless = false;              // True: a still picture as PNG
    bool one_shot = false;              // True: one still picture at full accuracy, whatever the load; then nothing
    uint8_t draw_hz = 0;                // above 0: the viewer draws by itself, from so many LitTicks a second at most
    uint8_t layers = 0;                 // layers with depth besides each picture; 0: none
    uint32_t follows = 0;               // id of the person whose camera this is; 0: the viewer's own
    Alpha alpha = Alpha::none;          // with one_shot alone
    uint8_t show = 0;                   // number of a view (common/view_names.h); 0: the picture itself
    Clock::time_point received{};
    Clock::time_point since{}; // when this view was first asked for; set by Viewer
};

// Bytes of one picture, JPEG or PNG. Viewers that ask for the same picture share them.
using Jpeg = std::shared_ptr<const std::vector<uint8_t>>;

// The layers with depth of one picture (shaders/shared/depth_layers.h), encoded. Numbers as wire::DepthLayers has them.
struct FrameLayers {
    uint8_t count = 0;
    uint16_t columns = 0, rows = 0, block_rows = 0;
    float spacing = 0, first = 0;
    float near = 0, far = 0; // m
    float exposure = 1;
    bool filmic = false;
    float nearest = 0; // m
    std::vector<uint8_t> colours, data, surface;

    size_t bytes() const { return colours.size() + data.size() + surface.size(); }
};
using LayersPtr = std::shared_ptr<const FrameLayers>; // shared as Jpeg is

// Relative RMSE of one viewer's pictures of the last half minute, and its bounds of 95 %. All 0: not known.
struct MeasuredError {
    float rmse = 0, low = 0, high = 0;
};

// The encoded pictures that answer one request. Immutable once delivered.
struct EncodedFrame {
    uint32_t id = 0; // counts up for each viewer; 0 is no frame
    uint64_t tick = 0, state_hash = 0;
    PoseRequest request;
    bool repeats = false; // True: an earlier frame answered this pose, so that wait_ms tells nothing about the server
    float wait_ms = 0, render_ms = 0, encode_ms = 0, gpu_ms = 0;
    float error = 0; // predicted relative RMSE of the picture, at most
    MeasuredError measured;
    Clock::time_point encoded{};
    std::array<Jpeg, 2> jpeg;        // one for each of request.views eyes
    std::array<LayersPtr, 2> layers; // the same; null: none were asked for
    bool png = false;                // True: all pictures are PNG; false: JPEG
    LitTickPtr lit;                  // the medium to draw, in place of pictures; null: there are pictures
    bool lit_whole = false;          // True: of `lit` the whole rows are sent; false: the changes

    // What of `lit` is sent.
    const lit::PackedRows& rows() const { return lit_whole ? lit->whole : lit->changes; }

    // Calls `part` with the bytes of each part of the message, in order, as std::span.
    template <class Part>
    void eachPart(const Part& part) const {
        if (lit) return part(std::span<const uint8_t>(rows().bytes));
        for (const Jpeg& picture : jpeg)
            if (picture) part(std::span<const uint8_t>(*picture));
        for (const LayersPtr& of : layers) {
            if (!of) continue;
            for (const auto* picture : {&of->colours, &of->data, &of->surface})
                part(std::span<const uint8_t>(*picture));
        }
    }
};
// Of all its views together.
double pixelsOf(const PoseRequest& request);
// True if both requests ask for the same pictures. Their numbers and times may differ.
bool samePictures(const PoseRequest& a, const PoseRequest& b);

using FramePtr = std::shared_ptr<const EncodedFrame>;

// Device time of one pass.
struct PassTime {
    std::string name;
    float ms = 0; // smoothed
};

} // namespace brume
