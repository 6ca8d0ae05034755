// Writes a running session: given every tick by the frame loop, on its thread.
#pragma once

#include <filesystem>
#include <memory>
#include <span>

#include "server/operate/own_frames.h"
#include "server/operate/recording.h"

namespace brume {

class Recorder {
public:
    struct Options {
        std::filesystem::path file;
        uint64_t most_bytes = 256ull << 20; // after which it ends; the server goes on
        uint32_t frames = 0;                // ticks between pictures of the scene's own camera; 0: none
    };
    // Throws RecordingError; gpu::Error with frames.
    Recorder(const Options& options, const RecordingHead& head, const Scene& scene, const gpu::Device& device);
    // Ends the recording.
    ~Recorder();

    // The simulation before its first tick, and after every tick, with what that took. A disk that is full is told to the log and
    // ends the recording, not the server. Throws gpu::Error with frames.
    void ticked(const Simulation& simulation, std::span<const Command> commands);

private:
    bool write(const RecordedTick& tick);
    void end(const char* why);

    const Options options_;
    const Scene scene_;
    const gpu::Device& device_;
    std::unique_ptr<RecordingWriter> out_; // null once it has ended
    std::unique_ptr<OwnFrames> pictures_;
    RecordedTick last_; // without commands
};

} // namespace brume
