#include "server/net/scene_news.h"

namespace brume::net {
namespace {

constexpr auto kStatePeriod = std::chrono::seconds(1);
constexpr size_t kManyElements = 512; // of all lists: about 20 KB
constexpr auto kLongLists = std::chrono::milliseconds(250);

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
    bool lists = lists_ != report->lists_hash;
    size_t elements = 0;
    for (const SceneList list : kSceneLists) elements += report->lists.size(list);
    if (lists && lists_ && elements > kManyElements && now - lists_told_ < kLongLists) lists = false;
    if (lists) lists_ = report->lists_hash, lists_told_ = now;
    return packSceneState(*report, audience_.size(), lists ? &audience_.facts() : nullptr);
}

} // namespace brume::net
