// The folder that frames and statistics are written to.
#pragma once

#include <filesystem>

#include "client/native/session.h"
#include "client/native/statistics.h"

namespace brume::client {

// Every failure throws std::runtime_error: one line with the path and the reason.
class Recorder {
public:
    // Makes the folder and proves that it can be written to. An empty path records nothing.
    Recorder(std::filesystem::path folder, bool save_frames);

    // frame-00001.jpg and so on; frame-00001-left.jpg and -right.jpg for two views. Precondition: `message` is a frame.
    void frame(const Received& message);
    void statistics(const Statistics& statistics);

private:
    std::filesystem::path folder_;
    bool save_frames_;
    uint32_t next_ = 1;
};

} // namespace brume::client
