// ReplayPictures: a film of a recording, as numbered files of pictures of the scene's own camera.
#pragma once

#include <filesystem>
#include <string>

#include "server/encode/picture_encoder.h"
#include "server/operate/own_frames.h"

namespace brume {

class ReplayPictures {
public:
    struct Options {
        std::filesystem::path folder; // made if it is not there; files of the same names are replaced
        uint32_t fps = 30;            // pictures a second, 1 ... 60
        bool png = false;             // True: PNG; false: JPEG of quality 95
        uint32_t width = 1280, height = 720;
    };
    // `first`, `last`: ticks of the recording. Throws gpu::Error, and RecordingError for a folder that cannot be made.
    ReplayPictures(const Options& options, const gpu::Device& device, const Scene& scene, uint32_t capacity,
                   uint64_t first, uint64_t last);

    // To be called with the first state and after every tick. Writes a picture where one is due: picture n belongs to
    // n / fps seconds. Throws gpu::Error, and RecordingError where a file cannot be written.
    void ticked(const Simulation& simulation);
    uint64_t written() const { return written_; }

private:
    uint64_t tickOf(uint64_t picture) const { return first_ + (picture * 60 + options_.fps / 2) / options_.fps; }

    const Options options_;
    const uint64_t first_, all_; // tick of the first state; number of pictures
    OwnFrames frames_;
    JpegEncoder jpeg_;
    uint64_t written_ = 0;
};

} // namespace brume
