// replay(): repeats a recorded session without network, and checks every recorded state and picture.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "server/gpu/device.h"
#include "server/operate/replay_pictures.h"

namespace brume {

struct ReplayOptions {
    std::filesystem::path file;
    // Ticks between pictures of the scene's own camera, whose hashes are printed. 0: no pictures, and no device is
    // needed.
    uint32_t frames = 0;
    gpu::DeviceOptions device;
    ReplayPictures::Options film; // of the whole recording; an empty folder: none
};

// Replays a file and reports on `out`. Throws RecordingError for a file that cannot be replayed, and for the first
// tick whose state or picture differs from the recorded one. Also throws SceneError and gpu::Error.
void replay(const ReplayOptions& options, std::ostream& out);

} // namespace brume
