#include "server/sim/lists.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "common/scene_limits.h"
#include "server/sim/settings_hash.h"
#include "server/sim/state_hash.h"

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

// Calls `f` with the vector of a list.
template <class Lists, class F>
decltype(auto) visit(Lists& lists, SceneList list, F&& f) {
    switch (list) {
    case SceneList::lights:
        return f(lists.lights);
    case SceneList::fogs:
        return f(lists.fogs);
    case SceneList::planes:
        return f(lists.planes);
    case SceneList::boxes:
        return f(lists.boxes);
    case SceneList::spheres:
        break;
    }
    return f(lists.spheres);
}

struct Exchange {
    StateBytes& bytes;
    void operator()(std::string* text) const { bytes.value(*text, kLongestName); }
    void operator()(glm::vec3* vector) const { bytes.value(*vector); }
    void operator()(float* number) const { bytes.value(*number); }
    void operator()(bool* flag) const { bytes.value(*flag); }
    template <class Other>
    void operator()(Other*) const {} // no element has one
};

} // namespace

void exchange(StateBytes& bytes, SceneLists& lists) {
    for (const SceneList list : kSceneLists) {
        visit(lists, list, [&](auto& elements) { elements.resize(bytes.size(elements.size(), mostOf(list))); });
        for (uint32_t element = 0; element < lists.size(list); ++element)
            for (const SceneSetting& setting : sceneSettings())
                if (setting.table() == nameOf(list))
                    std::visit(Exchange{bytes}, setting.member(partsOf(lists, list, element)));
    }
}

size_t SceneLists::size(SceneList list) const {
    return visit(*this, list, [](const auto& elements) { return elements.size(); });
}

SceneLists listsOf(const Scene& scene) {
    return {localLightsOf(scene),
            scene.fogs,
            scene.planes,
            {scene.boxes.begin(), scene.boxes.end() - scene.laid_out_boxes},
            {scene.spheres.begin(), scene.spheres.end() - scene.laid_out_spheres},
            scene.laid_out_boxes + scene.laid_out_spheres};
}

void setObjects(Scene& scene, const SceneLists& lists) {
    scene.planes = lists.planes;
    scene.boxes.erase(scene.boxes.begin(), scene.boxes.end() - scene.laid_out_boxes);
    scene.boxes.insert(scene.boxes.begin(), lists.boxes.begin(), lists.boxes.end());
    scene.spheres.erase(scene.spheres.begin(), scene.spheres.end() - scene.laid_out_spheres);
    scene.spheres.insert(scene.spheres.begin(), lists.spheres.begin(), lists.spheres.end());
}

SceneList listOf(const SceneSetting& setting) { return *sceneList(setting.table()); }

size_t mostOf(SceneList list) {
    switch (list) {
    case SceneList::lights:
        return size_t(limits::kLocalLights.hi);
    case SceneList::fogs:
        return size_t(limits::kFogs.hi);
    case SceneList::planes:
        return size_t(limits::kPlanes.hi);
    case SceneList::boxes:
    case SceneList::spheres:
        break;
    }
    return size_t(limits::kObjects.hi);
}

SceneParts partsOf(SceneLists& lists, SceneList list, uint32_t element) {
    switch (list) {
    case SceneList::lights:
        return {.light = &lists.lights[element]};
    case SceneList::fogs:
        return {.fog = &lists.fogs[element]};
    case SceneList::planes:
        return {.plane = &lists.planes[element]};
    case SceneList::boxes:
        return {.box = &lists.boxes[element]};
    case SceneList::spheres:
        break;
    }
    return {.sphere = &lists.spheres[element]};
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
    visit(lists, list, [](auto& elements) { elements.emplace_back(); });
    if (list == SceneList::lights) lists.lights.back().type = kPoint;
    for (const Change& one : changes) {
        if (!one.setting->in_list || listOf(*one.setting) != list)
            return fmt::format("{} is no setting of a new {}", one.setting->path, nameOf(list));
        if (std::string problem = change(lists, list, uint32_t(size), one); !problem.empty()) return problem;
    }
    return {};
}

std::string remove(SceneLists& lists, SceneList list, uint32_t element) {
    if (element >= lists.size(list)) return missing(lists, list, element);
    visit(lists, list, [&](auto& elements) { elements.erase(elements.begin() + element); });
    return {};
}

std::string insert(SceneLists& lists, SceneList list, uint32_t element, const SceneLists& from, uint32_t which) {
    if (element > lists.size(list)) return missing(lists, list, element);
    visit(lists, list, [&]<class T>(std::vector<T>& to) {
        visit(from, list, [&]<class U>(const std::vector<U>& elements) {
            if constexpr (std::is_same_v<T, U>) to.insert(to.begin() + element, elements[which]);
        });
    });
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
    if (const size_t bodies = lists.boxes.size() + lists.spheres.size() + lists.laid_out;
        !limits::kObjects.holds(double(bodies)))
        return fmt::format("{} boxes and spheres, {} is the most: remove one first", bodies, limits::kObjects.hi);
    return {};
}

uint64_t hashOf(SceneLists& lists) {
    uint64_t sum = 0;
    for (const SceneList list : kSceneLists) {
        if (lists.size(list) == 0) continue;
        sum += hashOf(nameOf(list), lists.size(list));
        for (uint32_t element = 0; element < lists.size(list); ++element)
            sum += hashOf(liveSettings(list), partsOf(lists, list, element), element);
    }
    return sum;
}

} // namespace brume
