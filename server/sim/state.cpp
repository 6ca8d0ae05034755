// A simulation's state as a hash, and as bytes.
#include "server/sim/state.h"

#include <algorithm>

#include "server/sim/settings_hash.h"
#include "server/sim/state_hash.h"

namespace brume {

// What can differ between two runs of one scene; the rest follows from the scene, which `origin` stands for.
uint64_t Simulation::State::hashed() {
    StateHash out;
    out.add(origin);
    for (const Rows run : motion->living())
        for (const Column c : {Column::x, Column::y, Column::z, Column::vx, Column::vy, Column::vz})
            out.add(std::span((*columns)[c] + run.begin, run.end - run.begin));
    out.add(std::span(&moved.x, 3));
    out.add(hashOf(liveSettings(), partsOf(now)));
    out.add(lists_hash);
    for (const Light& light : now.lists.lights)
        if (light.orbit != 0) out.add(std::span(&light.position.x, 3));
    out.add(steps);
    out.add(motion->history());
    return out.value();
}

// What is written here is all that can differ between two runs of one scene.
void Simulation::State::exchange(StateBytes& bytes) {
    uint64_t of = origin;
    bytes.value(of);
    if (of != origin) throw StateError("a state of another scene, or of other particles");
    bytes.value(tick);
    bytes.value(steps);
    bytes.value(moved);
    const SceneParts parts = partsOf(now);
    eachLive<glm::vec3>(parts, [&](glm::vec3& value) { bytes.value(value); });
    eachLive<float>(parts, [&](float& value) { bytes.value(value); });
    eachLive<uint32_t>(parts, [&](uint32_t& value) { bytes.value(value); });
    eachLive<bool>(parts, [&](bool& value) { bytes.value(value); });
    eachLive<std::string>(parts, [&](std::string& value) { bytes.value(value, kLongestName); });
    brume::exchange(bytes, now.lists);
    bytes.value(lists_hash); // of the lists after the last command: lights that orbit have moved since
    motion->exchange(bytes, *columns, {.number = steps, .volume = volume(), .settings = now.simulation});
    exchangeColumns(bytes);
    changes.exchange(bytes);
}

// Of living rows, and but for sigma, which settle() computes. A column that is as at the start is but a flag.
void Simulation::State::exchangeColumns(StateBytes& bytes) {
    for (uint32_t c = 0; c < static_cast<uint32_t>(Column::count); ++c) {
        const auto column = static_cast<Column>(c);
        if (column == Column::sigma) continue;
        float* now_there = (*columns)[column];
        const float* first = (*first_columns)[column];
        bool changed = false;
        for (const Rows run : motion->living())
            changed = changed || !std::equal(now_there + run.begin, now_there + run.end, first + run.begin);
        bytes.value(changed);
        for (const Rows run : motion->living())
            if (changed)
                bytes.values(std::span(now_there + run.begin, run.end - run.begin));
            else if (bytes.reads())
                std::copy(first + run.begin, first + run.end, now_there + run.begin);
    }
}

void Simulation::save(std::vector<std::byte>& out) const {
    out.clear();
    StateBytes bytes(out);
    state_->exchange(bytes);
    bytes.value(state_->hash);
}

void Simulation::load(std::span<const std::byte> from) {
    State& s = *state_;
    StateBytes bytes(from);
    s.exchange(bytes);
    uint64_t hash = 0;
    bytes.value(hash);
    ++s.settings_version;
    s.settle();
    if (hash != s.hash) throw StateError("a state whose hash is another than it says");
    if (!bytes.left().empty()) throw StateError("a state with something behind its end");
    countFrom(s.tick);
}

} // namespace brume
