// Classifies passes by name.
#pragma once

#include <string_view>

namespace brume::bench {

// True if a pass of a view renders the medium itself: not the background, not the sum of what lies between sheets of
// glass, and not the conversion to bytes for display.
inline bool ofMedium(std::string_view pass) {
    return pass != "opaque" && pass != "glass" && pass != "compose" && pass != "shade" && pass != "present";
}

} // namespace brume::bench
