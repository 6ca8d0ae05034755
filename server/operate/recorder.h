// Recorder: writes a running session to a file. The frame loop calls it at every tick, on its own thread.
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
        uint64_t most_bytes = 256ull << 20; // size at which the recording ends; the server goes on
        uint32_t frames = 0;                // ticks between pictures of the scene's own camera; 0: none
    };
    // Throws RecordingError; also gpu::Error if `frames` is not 0.
    Recorder(const Options& options, const RecordingHead& head, const Scene& scene, const gpu::Device& device);
    // Ends the recording.
    ~Recorder();

    // To be called before the first tick, and after every tick with the commands that it took. `follows`: false for the
    // first state, and for one that was loaded; the recording goes on with that in another file, as with goOn(). A full
    // disk ends the recording, not the server; the log says so. Throws gpu::Error if `frames` is not 0.
    void ticked(const Simulation& simulation, std::span<const Command> commands, bool follows);
    // To be called with what is known of the errors of viewers' pictures, on the same thread: once a second what has
    // changed is written, RecordedErrors::kMost viewers at most.
    void measured(std::span<const ViewError> errors) { errors_.set(errors); }
    // Another scene is shown, or another state of it; `why`, in a few words. The recording ends, and goes on in a file
    // beside it, NAME-2 and so on. On the same thread.
    void goOn(const RecordingHead& head, const Scene& scene, const Simulation& simulation, const char* why);

private:
    bool write(const RecordedTick& tick);
    void end(const char* why);

    const Options options_;
    RecordingHead head_;
    Scene scene_;
    uint32_t files_ = 1; // begun
    const gpu::Device& device_;
    std::unique_ptr<RecordingWriter> out_; // null once the recording has ended
    std::unique_ptr<OwnFrames> pictures_;
    RecordedTick last_;     // its commands are left out
    bool has_last_ = false; // True: last_ is a tick of this session
    RecordedErrors errors_;
    uint64_t begun_ = 0, commands_ = 0; // first tick and number of commands of the present file
    std::filesystem::path file_;        // the present one
};

} // namespace brume
