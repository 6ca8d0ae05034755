#include "server/frame/encoding.h"

#include <algorithm>
#include <utility>

#include <spdlog/spdlog.h>

#include "common/cores.h"
#include "server/encode/layers_encoder.h"
#include "server/encode/picture_encoder.h"

namespace brume {
namespace {

using Millis = std::chrono::duration<float, std::milli>;

// Threads: one for each core, in these bounds.
constexpr unsigned kLeast = 2, kMost = 16;

LayersPtr frameLayers(const DepthLayersView& view, const PlaneLayout& picture, int quality, JpegEncoder& jpeg) {
    EncodedLayers encoded = encodeLayers(view, picture, quality, jpeg);
    return std::make_shared<const FrameLayers>(FrameLayers{.count = uint8_t(view.count),
                                                           .columns = uint16_t(view.columns),
                                                           .rows = uint16_t(view.rows),
                                                           .block_rows = uint16_t(view.block_rows),
                                                           .spacing = float(view.spacing),
                                                           .first = view.first,
                                                           .near = view.near,
                                                           .far = view.far,
                                                           .exposure = view.exposure,
                                                           .filmic = view.filmic,
                                                           .nearest = encoded.nearest,
                                                           .colours = std::move(encoded.colours),
                                                           .data = std::move(encoded.data),
                                                           .surface = std::move(encoded.surface)});
}

EncodedPictures cutOut(const RawPicture& picture, Alpha alpha) {
    EncodedPictures out;
    out.bytes[0] =
        std::make_shared<const std::vector<uint8_t>>(alpha == Alpha::exr ? cutOutExr(picture) : cutOutPng(picture));
    out.format = PictureFormat::png;
    out.quality = 100;
    return out;
}

} // namespace

Encoding::Encoding(Metrics& metrics) : metrics_(metrics), workers_(std::clamp(usableCores(), kLeast, kMost)) {}

void Encoding::take(Batch& batch) {
    const std::span<const PictureView> pictures = batch.submission.pictures();
    const std::span<const DepthLayersView> layers = batch.submission.layers();
    batch.pending =
        uint32_t(std::ranges::count_if(batch.jobs, [&](const BatchJob& job) { return batch.isDrawnFor(job); }));
    for (const BatchJob& job : batch.jobs) {
        if (!batch.isDrawnFor(job)) continue;
        workers_.give([this, &batch, &job, views = pictures.subspan(job.first_eye, job.due.request.views),
                       of_views = layers.subspan(job.first_eye, job.due.request.views)](JpegEncoder& jpeg) {
            deliver(batch, job.pictures, views, of_views, jpeg);
            batch.pending.fetch_sub(1);
        });
    }
}

// Encodes one job's pictures, for all viewers that asked for the same ones. On an encoder's thread, where nothing may
// be thrown: a frame that cannot be made, for want of memory for example, is lost, and its viewer gets a later one.
void Encoding::deliver(const Batch& batch, uint32_t job, std::span<const PictureView> views,
                       std::span<const DepthLayersView> layers, JpegEncoder& jpeg) noexcept {
    size_t next = job; // first of the jobs that have not got their frame
    try {
        const PoseRequest& wanted = batch.jobs[job].due.request;
        const EncodedPictures pictures =
            batch.raw ? cutOut(*batch.raw, wanted.alpha)
                      : encodePictures(views, {wanted.quality, wanted.lossless, wanted.still_picture}, jpeg);
        std::array<LayersPtr, 2> layered;
        // A frame has layers of all its views or of none. Those of a method that has none are empty.
        const auto eyes = std::span(batch.eyes).subspan(batch.jobs[job].first_eye, views.size());
        if (std::ranges::all_of(eyes, [](const EyeRequest& eye) { return eye.depth_layers > 0; }))
            for (size_t view = 0; view < views.size(); ++view)
                layered[view] = frameLayers(layers[view], views[view].layout, wanted.quality, jpeg);
        const Clock::time_point encoded = Clock::now();
        metrics_.encoded(uint32_t(views.size()));
        for (; next < batch.jobs.size(); ++next) {
            const BatchJob& one = batch.jobs[next];
            if (one.pictures != job) continue;
            auto frame = std::make_shared<EncodedFrame>();
            frame->id = one.due.frame_id;
            frame->tick = batch.tick;
            frame->state_hash = batch.state_hash;
            frame->request = one.due.request;
            frame->request.quality = pictures.quality;
            frame->repeats = one.due.repeats;
            frame->wait_ms = Millis(batch.taken - one.due.request.received).count();
            frame->render_ms = Millis(batch.done - batch.taken).count();
            frame->encode_ms = Millis(encoded - batch.done).count();
            frame->gpu_ms = one.gpu_ms;
            frame->error = batch.error;
            frame->measured = one.measured;
            frame->encoded = encoded;
            frame->jpeg = pictures.bytes;
            frame->layers = layered;
            frame->png = pictures.format == PictureFormat::png;
            metrics_.rendered(*frame);
            one.viewer->deliver(std::move(frame));
        }
        return;
    } catch (const std::exception& e) {
        spdlog::error("a picture is lost: {}", e.what());
    } catch (...) {
        spdlog::error("a picture is lost");
    }
    for (; next < batch.jobs.size(); ++next) {
        if (batch.jobs[next].pictures != job) continue;
        metrics_.failed();
        batch.jobs[next].viewer->abandon(batch.jobs[next].due.frame_id);
    }
}

} // namespace brume
