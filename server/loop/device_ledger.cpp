#include "server/loop/device_ledger.h"

#include <algorithm>
#include <string_view>

namespace brume {
namespace {

constexpr float kSmoothing = 0.1f; // weight of the newest sample in a pass's time

} // namespace

DeviceLedger::Times DeviceLedger::book(std::span<const gpu::PassSample> samples, BatchContents& batch) {
    Times times;
    double pixels = 0;
    for (const EyeRequest& eye : batch.eyes) pixels += double(eye.width) * eye.height;
    for (const gpu::PassSample& sample : samples) {
        if (std::string_view(sample.name) == "show") times.shown_ms += double(sample.ms);
        (sample.view == gpu::kShared ? times.shared_ms : times.views_ms) += double(sample.ms);
    }
    for (BatchJob& job : batch.jobs) {
        const PoseRequest& request = job.due.request;
        const double own = double(request.width) * request.height * request.views;
        job.gpu_ms = 0;
        for (const gpu::PassSample& sample : samples) {
            if (sample.view == gpu::kEach)
                job.gpu_ms += sample.ms * float(own / pixels);
            else if (sample.view != gpu::kShared && sample.view - job.first_eye < request.views)
                job.gpu_ms += sample.ms;
        }
    }
    smoothPasses(samples, uint32_t(batch.eyes.size()));
    return times;
}

// A pass that runs for several views counts once, with its mean time for a view.
void DeviceLedger::smoothPasses(std::span<const gpu::PassSample> samples, uint32_t pictures) {
    for (PassTime& pass : passes_) {
        float ms = 0;
        uint32_t times = 0;
        for (const gpu::PassSample& sample : samples)
            if (pass.name == sample.name) ms += sample.ms, times = sample.view == gpu::kEach ? pictures : times + 1;
        if (times) pass.ms += kSmoothing * (ms / float(times) - pass.ms);
    }
    for (const gpu::PassSample& sample : samples)
        if (std::none_of(passes_.begin(), passes_.end(), [&](const PassTime& p) { return p.name == sample.name; }))
            passes_.push_back({sample.name, sample.view == gpu::kEach ? sample.ms / float(pictures) : sample.ms});
}

} // namespace brume
