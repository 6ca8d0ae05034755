#include "server/compile/compiled_ways.h"

#include <algorithm>
#include <sstream>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "server/methods/plans.h"

namespace brume {

WayShaders shadersOf(const RenderSettings& settings, bool still) {
    const MethodPlan* method = planOf(settings.method);
    return {settings.method, method ? method->shaders(settings) : 0, settings.rate, still};
}

WayShaders layerShadersOf(const RenderSettings& settings) {
    WayShaders way = shadersOf(settings, false);
    way.layers = true;
    return way;
}

std::string text(const WayShaders& way) {
    const char* kind = way.layers ? "layers" : way.still ? "still" : "moving";
    return fmt::format("{} {} {} {}", way.method, way.shaders, way.rate, kind);
}

std::optional<WayShaders> wayShaders(std::string_view text) {
    std::istringstream in{std::string(text)};
    WayShaders way;
    std::string kind, more;
    if (!(in >> way.method >> way.shaders >> way.rate >> kind) || in >> more) return {};
    if ((kind != "still" && kind != "moving" && kind != "layers") || !planOf(way.method)) return {};
    way.still = kind == "still", way.layers = kind == "layers";
    return way;
}

void CompiledWays::setAll(bool all) {
    const std::scoped_lock lock(mutex_);
    all_ = all;
    ++version_;
}

bool CompiledWays::hasAll() const {
    const std::scoped_lock lock(mutex_);
    return all_;
}

void CompiledWays::clear(const SceneFeatures& lists) {
    const std::scoped_lock lock(mutex_);
    compiled_.clear();
    wanted_.clear();
    next_.reset();
    features_ = lists;
}

void CompiledWays::add(const WayShaders& way, bool probed) { add(features(), way, probed); }

void CompiledWays::add(const SceneFeatures& lists, const WayShaders& way, bool probed) {
    const std::scoped_lock lock(mutex_);
    const Clock::time_point now = Clock::now();
    const auto [known, is_new] = compiled_[lists].try_emplace(way);
    known->second.probed |= probed;
    known->second.used = now;
    forgetUnused(now);
    if (!is_new || lists != features_) return;
    std::erase_if(wanted_, [&](const Wanted& wanted) { return wanted.shaders == way; });
    ++version_;
}

void CompiledWays::use(const RenderSettings& settings, bool still, Clock::time_point now) {
    const std::scoped_lock lock(mutex_);
    const auto found = compiled_.find(features_);
    if (found == compiled_.end()) return;
    const auto way = found->second.find(shadersOf(settings, still));
    if (way != found->second.end()) way->second.used = now;
}

// Lists without a way that is left are wanted anew when they come.
void CompiledWays::forgetUnused(Clock::time_point now) {
    std::vector<std::pair<Clock::time_point, std::pair<SceneFeatures, WayShaders>>> unused;
    for (const auto& [lists, ways] : compiled_)
        for (const auto& [way, state] : ways)
            if (!way.method.empty() && now - state.used > kUnused) unused.push_back({state.used, {lists, way}});
    if (unused.size() <= kMostUnused) return;
    std::ranges::sort(unused);
    for (size_t i = 0; i + kMostUnused < unused.size(); ++i) {
        const auto& [lists, way] = unused[i].second;
        Ways& ways = compiled_[lists];
        ways.erase(way);
        const bool empty = std::ranges::all_of(ways, [](const auto& one) { return one.first.method.empty(); });
        if (empty && lists != features_) compiled_.erase(lists);
    }
}

const CompiledWays::Ways& CompiledWays::compiled() const {
    static const Ways kNone;
    const auto found = compiled_.find(features_);
    return found == compiled_.end() ? kNone : found->second;
}

SceneFeatures CompiledWays::features() const {
    const std::scoped_lock lock(mutex_);
    return features_;
}

bool CompiledWays::follow(const SceneFeatures& lists) {
    const std::scoped_lock lock(mutex_);
    if (lists != features_ && !all_ && !compiled_.contains(lists)) {
        if (next_ != lists && on_want_) on_want_();
        next_ = lists;
        return false;
    }
    next_.reset();
    if (lists == features_) return true;
    features_ = lists;
    wanted_.clear();
    ++version_;
    return true;
}

std::optional<SceneFeatures> CompiledWays::wantedFeatures() const {
    const std::scoped_lock lock(mutex_);
    return next_ && !compiled_.contains(*next_) ? next_ : std::nullopt;
}

bool CompiledWays::has(const RenderSettings& settings, bool still) const {
    const std::scoped_lock lock(mutex_);
    return all_ || compiled().contains(shadersOf(settings, still));
}

bool CompiledWays::mayProbe(const RenderSettings& settings) const {
    const std::scoped_lock lock(mutex_);
    const auto known = compiled().find(shadersOf(settings, false));
    return all_ || (known != compiled().end() && known->second.probed);
}

bool CompiledWays::mayHaveLayers(const RenderSettings& settings) {
    const std::scoped_lock lock(mutex_);
    const WayShaders way = layerShadersOf(settings);
    if (all_) return true;
    if (const auto ways = compiled_.find(features_); ways != compiled_.end())
        if (const auto known = ways->second.find(way); known != ways->second.end()) {
            known->second.used = Clock::now();
            return true;
        }
    want(settings, way);
    return false;
}

void CompiledWays::want(const RenderSettings& settings, bool still) {
    const std::scoped_lock lock(mutex_);
    want(settings, shadersOf(settings, still));
}

void CompiledWays::want(const RenderSettings& settings, const WayShaders& way) {
    const auto same = [&](const Wanted& wanted) { return wanted.shaders == way; };
    if (all_ || compiled().contains(way) || std::ranges::any_of(wanted_, same) || wanted_.size() >= kMostWanted) return;
    wanted_.push_back({settings, way, features_});
    if (on_want_) on_want_();
}

void CompiledWays::serve(std::function<void()> on_want) {
    const std::scoped_lock lock(mutex_);
    on_want_ = std::move(on_want);
}

std::optional<CompiledWays::Wanted> CompiledWays::nextWanted(const std::function<bool(const Wanted&)>& which) const {
    const std::scoped_lock lock(mutex_);
    for (const bool still : {false, true})
        for (const Wanted& wanted : wanted_)
            if (wanted.shaders.still == still && (!which || which(wanted))) return wanted;
    return {};
}

bool CompiledWays::addPipeline(const std::string& text) {
    const std::scoped_lock lock(mutex_);
    return pipelines_.insert(text).second;
}

uint64_t CompiledWays::version() const {
    const std::scoped_lock lock(mutex_);
    return version_;
}

} // namespace brume
