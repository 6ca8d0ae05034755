// MadeFor: what something was made for last, so that it is made again only for something else.
#pragma once

#include <optional>

#include "server/inputs/medium_view.h"
#include "server/inputs/tick_inputs.h"

namespace brume {

// Numbers that change with what most effects depend on. Effects that depend on more have them in a key of their own.
struct Versions {
    uint64_t medium = 0;    // MediumView::version
    uint64_t objects = 0;   // TickInputs::objects_version
    uint64_t sun_depth = 0; // TickInputs::sun_depth_version
    std::array<float, 1 + gpu::kMostFogs> hue_parts{};
    bool operator==(const Versions&) const = default;
};
inline Versions versionsOf(const TickInputs& tick, const MediumView& medium) {
    return {medium.version, tick.objects_version, tick.sun_depth_version, tick.hue_parts};
}

template <class Key>
class MadeFor {
public:
    // True: it was made for another key, and is to be made again. This key is remembered.
    bool outdated(const Key& key) {
        if (key_ == key) return false;
        key_ = key;
        return true;
    }
    void forget() { key_.reset(); }

private:
    std::optional<Key> key_;
};

} // namespace brume
