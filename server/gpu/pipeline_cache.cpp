#include "server/gpu/pipeline_cache.h"

#include <algorithm>

namespace brume::gpu {

std::shared_ptr<const Pipeline> PipelineCache::find(const Key& key) {
    const std::scoped_lock lock(mutex_);
    const auto found = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& kept) { return kept.key == key; });
    if (found == kept_.end()) return nullptr;
    kept_.splice(kept_.begin(), kept_, found);
    return kept_.front().pipeline;
}

void PipelineCache::keep(Key key, std::shared_ptr<const Pipeline> pipeline) {
    const std::scoped_lock lock(mutex_);
    for (const auto& made : listeners_) made(pipeline->text);
    kept_.push_front({std::move(key), std::move(pipeline)});
    size_t unused = 0;
    std::erase_if(kept_, [&](const Kept& kept) { return kept.pipeline.use_count() == 1 && ++unused > kMostUnused; });
}

PipelineListener::PipelineListener(PipelineCache& pipelines, std::function<void(const std::string&)> made)
    : pipelines_(pipelines) {
    const std::scoped_lock lock(pipelines_.mutex_);
    place_ = pipelines_.listeners_.insert(pipelines_.listeners_.end(), std::move(made));
}

PipelineListener::~PipelineListener() {
    const std::scoped_lock lock(pipelines_.mutex_);
    pipelines_.listeners_.erase(place_);
}

size_t PipelineCache::size() const {
    const std::scoped_lock lock(mutex_);
    return kept_.size();
}

} // namespace brume::gpu
