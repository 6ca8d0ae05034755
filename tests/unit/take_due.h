// takeDue(): polls a viewer for its due request and takes it at once. The server chooses among all viewers between
// these two steps; tests of one viewer do not need that.
#pragma once

#include "server/viewer/viewer.h"

namespace brume {

inline std::optional<Viewer::Due> takeDue(Viewer& viewer, Clock::time_point now = Clock::now(),
                                          std::optional<uint64_t> scene = {}, bool still_picture = false) {
    auto request = viewer.pollDue(now, scene, still_picture);
    if (!request) request = viewer.pollOneShot();
    return request ? viewer.take(*request, now, scene) : std::nullopt;
}

} // namespace brume
