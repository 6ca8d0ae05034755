// The lists of a scene that commands change while the server runs: points and spots, and fogs.
#pragma once

#include <string>
#include <vector>

#include "common/settings.h"
#include "server/sim/state_hash.h"

namespace brume {

struct SceneLists {
    std::vector<Light> lights; // points and spots
    std::vector<Fog> fogs;

    size_t size(SceneList list) const { return list == SceneList::lights ? lights.size() : fogs.size(); }
};

// Of a setting that is in a list.
inline SceneList listOf(const SceneSetting& setting) {
    return setting.table() == "fog" ? SceneList::fogs : SceneList::lights;
}
// The most elements that it may have.
size_t mostOf(SceneList list);
// Where the settings of an element lie. Precondition: element < lists.size(list).
SceneParts partsOf(SceneLists& lists, SceneList list, uint32_t element);

// Each changes the lists as a command asks, or says in one line why it cannot. The lists may be changed in part then.
std::string set(SceneLists& lists, const std::vector<Change>& changes); // settings that are in no list are left out
std::string add(SceneLists& lists, SceneList list, const std::vector<Change>& changes); // after the others
std::string remove(SceneLists& lists, SceneList list, uint32_t element);

// What is wrong with lists as a whole, in one line; empty: nothing. `particles`: true if the medium has any.
std::string problemOf(const SceneLists& lists, bool particles);

// Of all live settings of all elements. Changes nothing.
uint64_t hashOf(SceneLists& lists);

} // namespace brume
