// What commands have changed, so that the newest change can be taken back. Bounded, and part of the state.
#pragma once

#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "server/sim/command.h"
#include "server/sim/lists.h"

namespace brume {

inline constexpr size_t kMostUndone = 32;         // changes that are kept; older ones are forgotten
inline constexpr size_t kMostUndoneChanges = 256; // settings of one change; one of more is not kept

// How the scene was before a change.
struct MoveBack {
    glm::vec3 moved{0}; // m, the volume
};
struct PutBack {
    SceneList list = SceneList::fogs;
    uint32_t element = 0; // where it was
    SceneLists removed;   // has that element alone
};
struct Before {
    uint64_t tick = 0;      // of the change
    bool operators = false; // True: only operators may make such a change, or take it back
    std::variant<MoveBack, Set, Remove, PutBack> back;
};

class ChangeStack {
public:
    ChangeStack() { stack_.reserve(kMostUndone); }

    bool empty() const { return stack_.empty(); }
    const Before& newest() const { return stack_.back(); }
    // To be called after a change. A drag is one change: settings that change again within half a second keep the
    // values of before the first time. `after`: the values that such settings have now, in the order of Before::back.
    void keep(Before before, const std::vector<SettingValue>& after = {});
    Before take(); // Precondition: not empty()
    void clear() { stack_.clear(); }
    // What taking the newest back does, in a few words for people; empty: there is nothing to take back.
    std::string text() const;
    // Throws StateError.
    void exchange(StateBytes& bytes);

private:
    std::vector<Before> stack_; // the newest last
    bool open_ = false;         // True: the newest change may still go on
};

// A change of settings, backwards: the values that they have now. `partsFor`: where the setting of a change lies; in
// a list none where there is no such element, and such a change is left out.
template <class PartsFor>
Set backOf(const Set& set, PartsFor partsFor) {
    Set back;
    for (auto one = set.changes.rbegin(); one != set.changes.rend(); ++one)
        if (const auto parts = partsFor(*one)) {
            back.changes.push_back(*one);
            back.changes.back().value = valueOf(*one->setting, *parts);
        }
    return back;
}

} // namespace brume
