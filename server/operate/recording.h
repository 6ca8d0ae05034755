// A recorded session on disk: the scene it began with, and every command with the tick that took it.
//
// A text file, one line a record, each written whole by one write() as soon as it is known:
//
//   brume-recording 2
//   0123456789abcdef {"scene":"plume",...}                        what it was recorded from: Head
//   0123456789abcdef {"tick":0,"state":"fedcba9876543210"}        the state before the first tick
//   0123456789abcdef {"tick":17,"state":"...","commands":[...]}   a tick with commands, or one of every second
//   0123456789abcdef {"tick":60,"state":"...","frame":"..."}      also a picture of the scene's own camera
//   0123456789abcdef {"tick":99,"state":"...","end":"stopped"}    the last line of a server that ended by itself
//
// The 16 digits are the XXH3 hash of the digits of the line before (for the first: of "brume-recording 2") and of the JSON, so
// that no line can be changed, left out or moved without notice. "state" is Simulation::stateHash() after the tick, "frame" a
// hash of the picture.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/sim/command.h"

namespace brume {

struct RecordingHead {
    std::string scene;                  // its name
    std::string file;                   // where its text was read from; a particle file is found beside it
    std::string text;                   // of the scene, as it was
    std::vector<std::string> overrides; // key=value, in the order in which they apply
    std::string server;                 // version that recorded
};

struct RecordedTick {
    uint64_t tick = 0, state_hash = 0;
    std::vector<Command> commands; // taken by this tick, in order
    std::optional<uint64_t> frame; // hash of the picture of the scene's own camera, 640x360
    std::string end;               // why the recording ends here; empty where it goes on
};

// One line: "FILE:LINE: what is wrong".
struct RecordingError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Appends. Throws RecordingError when the file cannot be made or written.
class RecordingWriter {
public:
    // A file that is there already is kept as FILE.old.
    RecordingWriter(const std::filesystem::path& file, const RecordingHead& head, uint64_t most_bytes = ~0ull);
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    // False, and nothing is written, when that would make the file larger than `most_bytes`, or leave no room there for an end.
    [[nodiscard]] bool write(const RecordedTick& tick);

private:
    void writeLine(const std::string& json);
    void writeBytes(const std::string& bytes);

    const std::string file_;
    const uint64_t most_bytes_;
    int fd_ = -1;
    uint64_t bytes_ = 0;
    std::string hash_; // of the last line
};

// Reads and verifies. Throws RecordingError for a file that is none, of another version, changed, or cut within its first lines.
class RecordingReader {
public:
    explicit RecordingReader(const std::filesystem::path& file);

    const RecordingHead& head() const { return head_; }
    // The next record; nothing at the end.
    std::optional<RecordedTick> next();
    // After the end: the last line was incomplete and left out, as a server that was killed while it wrote leaves it.
    bool cut() const { return cut_; }

private:
    std::optional<std::string> line(); // whole, without its end
    std::optional<std::string> verified();
    [[noreturn]] void fail(const std::string& what) const;

    const std::string file_;
    std::ifstream in_;
    size_t number_ = 0; // of the line
    std::string hash_;
    RecordingHead head_;
    std::optional<uint64_t> last_tick_;
    bool cut_ = false, ended_ = false;
};

// 16 hexadecimal digits.
std::string hexOf(uint64_t value);

} // namespace brume
