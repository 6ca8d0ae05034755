// Writes frames and statistics to a folder.
#pragma once

#include <filesystem>
#include <span>

#include "client/native/jpeg.h"
#include "client/native/session.h"
#include "client/native/statistics.h"

namespace brume::client {

// Every failure here throws std::runtime_error: one line with the path and the reason.
void writeFile(const std::filesystem::path& path, std::span<const char> bytes);
void writePng(const std::filesystem::path& path, const Picture& picture);

class Recorder {
public:
    // Creates the folder and checks that it can be written to. With an empty path nothing is recorded.
    Recorder(std::filesystem::path folder, bool save_frames);

    // Writes frame-00001.jpg and so on; for two views frame-00001-left.jpg and -right.jpg. Precondition: `message` is
    // a frame.
    void frame(const Received& message);
    // Writes a picture that was drawn here, frame-00001.png and so on.
    void picture(const Picture& picture);
    void statistics(const Statistics& statistics);

private:
    std::filesystem::path folder_;
    bool save_frames_;
    uint32_t next_ = 1;
};

} // namespace brume::client
