#include "server/net/scene_news.h"

#include <utility>

namespace brume::net {
namespace {

constexpr auto kStatePeriod = std::chrono::seconds(1);

} // namespace

bool SceneNews::due(Clock::time_point now) const {
    return audience_.revision() != revision_ || now - told_ >= kStatePeriod;
}

const SceneFacts& SceneNews::takeScene() {
    shown_ = audience_.scene();
    lists_.reset();
    return *shown_;
}

wire::Packed SceneNews::takeState(Clock::time_point now) {
    revision_ = audience_.revision(); // read before the report: a change in between is sent again
    told_ = now;
    const auto report = audience_.report();
    const bool lists = std::exchange(lists_, report->lists_hash) != report->lists_hash;
    return packSceneState(*report, audience_.size(), lists ? &audience_.facts() : nullptr);
}

} // namespace brume::net
