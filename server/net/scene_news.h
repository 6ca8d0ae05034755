// SceneNews: what one viewer was told of the scene, and when there is more to tell.
#pragma once

#include <memory>
#include <optional>

#include "server/net/outgoing.h"
#include "server/viewer/audience.h"

namespace brume::net {

class SceneNews {
public:
    explicit SceneNews(const Audience& audience) : audience_(audience) {}

    // True: something changed, or the last state is a second old.
    bool due(Clock::time_point now) const;
    // True: another scene is shown than the viewer knows. It is told of by a Welcome, before its state.
    bool anotherScene() const { return audience_.scene() != shown_; }
    // The scene for a Welcome. It counts as told.
    const SceneFacts& takeScene();
    // A SceneState. It counts as told. It has the scene's lists only where the viewer does not know them. Long ones
    // come in four states a second at most, the last change within a second.
    wire::Packed takeState(Clock::time_point now);

private:
    const Audience& audience_;
    uint64_t revision_ = 0;                   // Audience::revision()
    std::shared_ptr<const SceneFacts> shown_; // null: none yet
    std::optional<uint64_t> lists_;           // SceneReport::lists_hash; nothing: none yet of this scene
    Clock::time_point told_{};                // when the last state was
    Clock::time_point lists_told_{};          // when the lists were last
};

} // namespace brume::net
