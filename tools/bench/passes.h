// Passes by what they are for.
#pragma once

#include <string_view>

namespace brume::bench {

// Of a view's passes those of the medium itself: without the background, and without what makes bytes for display of it.
inline bool ofMedium(std::string_view pass) {
    return pass != "opaque" && pass != "compose" && pass != "shade" && pass != "present";
}

} // namespace brume::bench
