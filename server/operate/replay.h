// Steps a recorded session anew, without network, and checks every recorded state and picture.
#pragma once

#include <filesystem>
#include <iosfwd>

#include "server/gpu/device.h"

namespace brume {

struct ReplayOptions {
    std::filesystem::path file;
    uint32_t frames =
        0; // ticks between pictures of the scene's own camera, whose hashes are printed; 0: none, and no device is needed
    gpu::DeviceOptions device;
};

// Says on `out` what was replayed. Throws RecordingError for a file that cannot be replayed and for the first tick whose state or
// picture is another one than recorded; SceneError, gpu::Error.
void replay(const ReplayOptions& options, std::ostream& out);

} // namespace brume
