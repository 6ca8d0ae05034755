// CompiledWays: the ways to render whose shaders are compiled, and those that are wanted. A CPU driver takes up to
// seconds to compile one, and everyone would wait. Thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "server/inputs/scene_features.h"
#include "server/plan/ready_ways.h"

namespace brume {

// What the shaders of a picture depend on, of its settings.
struct WayShaders {
    std::string method;
    uint32_t shaders = 0; // MethodPlan::shaders()
    uint32_t rate = 0;    // pixels
    bool still = false;   // True: of still pictures, which have full colour
    bool layers = false;  // True: of pictures with layers with depth, still or not

    auto operator<=>(const WayShaders&) const = default; // NOLINT(modernize-use-nullptr): it takes this for a 0
};
WayShaders shadersOf(const RenderSettings& settings, bool still);
WayShaders layerShadersOf(const RenderSettings& settings);
// One line: "METHOD SHADERS RATE moving", or "still", or "layers"; and back. Nothing: it is no such line.
std::string text(const WayShaders& way);
std::optional<WayShaders> wayShaders(std::string_view text);

class CompiledWays : public ReadyWays {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr size_t kMostUnused = 8;
    static constexpr std::chrono::seconds kUnused{20};

    // A way that somebody would be drawn with, if it were compiled.
    struct Wanted {
        RenderSettings settings;
        WayShaders shaders;
        SceneFeatures lists; // features of the lists that were drawn then
    };

    // True, as it is at first: every way may be used at once; nothing is compiled behind.
    void setAll(bool all);
    bool hasAll() const;
    // Forgets all ways, for another scene with these features that commands change: brume::featuresOf().
    void clear(const SceneFeatures& lists = {});
    // Of the lists that are drawn. `probed`: true if the shader that reads its pixels back is compiled, too.
    void add(const WayShaders& way, bool probed = true);
    // Of lists with these features, drawn or not. A way without a method: nothing more can be compiled for them behind.
    void add(const SceneFeatures& lists, const WayShaders& way, bool probed = true);

    // Of the lists that are drawn.
    SceneFeatures features() const;
    // True: lists with these features are drawn from now on. False: no way is compiled for them. They are wanted, and
    // who compiles is told.
    bool follow(const SceneFeatures& lists);
    // The wanted ones. Nothing: those that are drawn are right, or a way is compiled for the others.
    std::optional<SceneFeatures> wantedFeatures() const;
    bool has(const RenderSettings& settings, bool still) const override;
    // True: the way's pictures may have layers with depth. False: that is wanted from now on.
    bool mayHaveLayers(const RenderSettings& settings);
    // Of ways that nobody used for kUnused, kMostUnused stay at most, since a device keeps some pipelines only.
    void use(const RenderSettings& settings, bool still) override { use(settings, still, Clock::now()); }
    void use(const RenderSettings& settings, bool still, Clock::time_point now);
    // True: pixels of moving pictures of this way may be read back.
    bool mayProbe(const RenderSettings& settings) const;
    // Tells who compiles, unless the way is compiled. At most kMostWanted wait.
    void want(const RenderSettings& settings, bool still) override;
    // `on_want` is called by want() and follow(), in their thread, for everything new.
    void serve(std::function<void()> on_want);
    // The way that was wanted first and is not compiled yet, of those for which `which` is true. Those of moving
    // pictures come before those of still ones.
    std::optional<Wanted> nextWanted(const std::function<bool(const Wanted&)>& which = {}) const;
    // A process has compiled this pipeline: gpu::PipelineListener. False: that is known already.
    bool addPipeline(const std::string& text);
    // Grows with every way that has() becomes true for.
    uint64_t version() const;

private:
    static constexpr size_t kMostWanted = 16;

    struct State {
        bool probed = false;
        Clock::time_point used{}; // or added
    };
    using Ways = std::map<WayShaders, State>;
    const Ways& compiled() const; // ways of features_
    void want(const RenderSettings& settings, const WayShaders& way);
    void forgetUnused(Clock::time_point now);

    mutable std::mutex mutex_;
    std::map<SceneFeatures, Ways> compiled_;
    std::set<std::string> pipelines_; // texts of all scenes' pipelines that the driver has on disk
    SceneFeatures features_;
    std::optional<SceneFeatures> next_; // that are wanted
    std::deque<Wanted> wanted_;
    std::function<void()> on_want_;
    uint64_t version_ = 0;
    bool all_ = true;
};

} // namespace brume
