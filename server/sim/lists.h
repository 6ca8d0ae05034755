// The lists of a scene that commands change while the server runs: points and spots, fogs, and objects.
#pragma once

#include <string>
#include <vector>

#include "common/settings.h"
#include "server/sim/state_bytes.h"

namespace brume {

struct SceneLists {
    std::vector<Light> lights; // points and spots
    std::vector<Fog> fogs;
    std::vector<Plane> planes;
    std::vector<Box> boxes; // but those of [objects], as the spheres are
    std::vector<Sphere> spheres;
    uint32_t laid_out = 0; // boxes and spheres of [objects], which commands leave as they are

    size_t size(SceneList list) const;
};
// Those that the scene begins with.
SceneLists listsOf(const Scene& scene);
// Gives the scene the objects of the lists, in front of those of [objects].
void setObjects(Scene& scene, const SceneLists& lists);

// Of a setting that is in a list.
SceneList listOf(const SceneSetting& setting);
// The most elements that it may have.
size_t mostOf(SceneList list);
// Where the settings of an element lie. Precondition: element < lists.size(list).
SceneParts partsOf(SceneLists& lists, SceneList list, uint32_t element);

// Each changes the lists as a command asks, or says in one line why it cannot. The lists may be changed in part then.
std::string set(SceneLists& lists, const std::vector<Change>& changes); // settings that are in no list are left out
std::string add(SceneLists& lists, SceneList list, const std::vector<Change>& changes); // after the others
std::string remove(SceneLists& lists, SceneList list, uint32_t element);
// Puts a copy of an element of other lists in front of the one that is `element` now, or behind the last.
std::string insert(SceneLists& lists, SceneList list, uint32_t element, const SceneLists& from, uint32_t which = 0);

// What is wrong with lists as a whole, in one line; empty: nothing. `particles`: true if the medium has any.
std::string problemOf(const SceneLists& lists, bool particles);

// Writes or reads all elements with all settings that a scene file gives them. Throws StateError.
void exchange(StateBytes& bytes, SceneLists& lists);

// Of all live settings of all elements, and how many there are. Changes nothing.
uint64_t hashOf(SceneLists& lists);

} // namespace brume
