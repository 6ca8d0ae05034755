// Encoding: planes of pictures become JPEG or PNG on threads of its own, and frames for viewers.
#pragma once

#include "server/encode/workers.h"
#include "server/frame/batch.h"
#include "server/metrics/metrics.h"

namespace brume {

class Encoding {
public:
    // `metrics` outlives it.
    explicit Encoding(Metrics& metrics);

    // Encodes the batch's pictures and delivers them, on the threads. The device is done with it; it stays until
    // Batch::isFree().
    void take(Batch& batch);

    EncodeWorkers& workers() { return workers_; }
    uint64_t bytes() const { return workers_.bytes(); }
    void giveBack() { workers_.giveBack(); }

private:
    void deliver(const Batch& batch, uint32_t job, std::span<const PictureView> views,
                 std::span<const DepthLayersView> layers, JpegEncoder& jpeg) noexcept;

    Metrics& metrics_;
    EncodeWorkers workers_;
};

} // namespace brume
