#include "server/sim/lists.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "common/scene_limits.h"

namespace brume {
namespace {

std::string missing(const SceneLists& lists, SceneList list, uint32_t element) {
    const size_t size = lists.size(list);
    const std::string_view name = nameOf(list);
    if (size == 0) return fmt::format("there is no {}[{}]: there is none at all", name, element);
    return fmt::format("there is no {}[{}]: the last one is {}[{}]", name, element, name, size - 1);
}

std::string change(SceneLists& lists, SceneList list, uint32_t element, const Change& change) {
    const SceneParts parts = partsOf(lists, list, element);
    const std::string_view key = change.setting->key();
    apply(change, parts);
    if (parts.light && !isLocal(*parts.light)) return fmt::format("light[{}] is a point or a spot", element);
    if (parts.light && !has(*parts.light, key))
        return fmt::format("light[{}] is a {}, which has no {}", element, parts.light->type, key);
    return {};
}

struct AddTo {
    StateHash& hash;
    void operator()(const std::string* text) const { hash.add(std::string_view(*text)); }
    void operator()(const glm::vec3* vector) const { hash.add(std::span(&vector->x, 3)); }
    void operator()(const float* number) const { hash.add(std::span(number, 1)); }
    void operator()(const bool* flag) const { hash.add(uint64_t{*flag}); }
    template <class Other>
    void operator()(const Other*) const {} // no element has one
};

} // namespace

size_t mostOf(SceneList list) { return size_t(list == SceneList::lights ? limits::kLocalLights.hi : limits::kFogs.hi); }

SceneParts partsOf(SceneLists& lists, SceneList list, uint32_t element) {
    if (list == SceneList::lights) return {.light = &lists.lights[element]};
    return {.fog = &lists.fogs[element]};
}

std::string set(SceneLists& lists, const std::vector<Change>& changes) {
    for (const Change& one : changes) {
        if (!one.setting->in_list) continue;
        const SceneList list = listOf(*one.setting);
        if (one.element >= lists.size(list)) return missing(lists, list, one.element);
        if (std::string problem = change(lists, list, one.element, one); !problem.empty()) return problem;
    }
    return {};
}

std::string add(SceneLists& lists, SceneList list, const std::vector<Change>& changes) {
    const size_t size = lists.size(list);
    if (size >= mostOf(list))
        return fmt::format("there are {} already, {} is the most: remove one first", size, mostOf(list));
    if (list == SceneList::lights)
        lists.lights.push_back({.type = kPoint});
    else
        lists.fogs.emplace_back();
    for (const Change& one : changes) {
        if (!one.setting->in_list || listOf(*one.setting) != list)
            return fmt::format("{} is no setting of a new {}", one.setting->path, nameOf(list));
        if (std::string problem = change(lists, list, uint32_t(size), one); !problem.empty()) return problem;
    }
    return {};
}

std::string remove(SceneLists& lists, SceneList list, uint32_t element) {
    if (element >= lists.size(list)) return missing(lists, list, element);
    if (list == SceneList::lights)
        lists.lights.erase(lists.lights.begin() + element);
    else
        lists.fogs.erase(lists.fogs.begin() + element);
    return {};
}

std::string problemOf(const SceneLists& lists, bool particles) {
    for (size_t i = 0; i < lists.fogs.size(); ++i)
        if (!(lists.fogs[i].lo < lists.fogs[i].hi)) return fmt::format("fog[{}]: lo must be below hi", i);
    for (size_t i = 0; i < lists.lights.size(); ++i)
        if (!(lists.lights[i].inner < lists.lights[i].outer))
            return fmt::format("light[{}]: inner must be below outer", i);
    const auto shadowed = std::ranges::count_if(lists.lights, &Light::shadows);
    if (particles && !limits::kShadowedLights.holds(double(shadowed)))
        return fmt::format("{} points and spots with shadows among particles, {} is the most: others without shadows",
                           shadowed, limits::kShadowedLights.hi);
    return {};
}

uint64_t hashOf(SceneLists& lists) {
    StateHash hash;
    for (const SceneList list : kSceneLists) {
        hash.add(uint64_t{lists.size(list)});
        for (uint32_t element = 0; element < lists.size(list); ++element)
            for (const SceneSetting* setting : liveSettings(list))
                std::visit(AddTo{hash}, setting->member(partsOf(lists, list, element)));
    }
    return hash.value();
}

} // namespace brume
