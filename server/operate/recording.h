// A recorded session on disk: the scene it began with, and every command with the tick that took it.
//
// A text file, one line a record, each written whole by one write() as soon as it is known:
//
//   brume-recording 15
//   0123456789abcdef {"scene":"plume",...}                        the scene and its overrides: RecordingHead
//   0123456789abcdef {"tick":0,"state":"fedcba9876543210"}        the state before the first tick
//   0123456789abcdef {"tick":17,"state":"...","commands":[...]}   every tick with commands, and one each second
//   0123456789abcdef {"tick":60,"state":"...","frame":"..."}      a tick with a picture of the scene's own camera
//   0123456789abcdef {"tick":60,"state":"...","errors":[...]}     measured errors of viewers' pictures
//   0123456789abcdef {"tick":99,"state":"...","end":"stopped"}    the last line of a server that ended by itself
//
// The 16 digits are an XXH3 hash of the previous line's digits (for the first: of "brume-recording 15") and of the
// JSON. A line that was changed, left out or moved is detected by it. "state" is Simulation::stateHash() after the
// tick, "frame" a hash of the picture. A command is {"viewer":1,"input":"..."}: who asked, and the message Input of
// brume.v1 in base64 (server/net/command_message.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "server/operate/recorded_errors.h"
#include "server/sim/command.h"

namespace brume {

// Another number: the file's format is another. Settings that are new, or gone without use, change no hash of a state.
inline constexpr int kRecordingVersion = 15;
// Ticks between records at most: a replay that goes astray is noticed within a second of the session, and no line makes
// it simulate for days.
inline constexpr uint64_t kRecordEvery = 60;

struct RecordingHead {
    std::string scene;                  // name of the scene
    std::string file;                   // path of the scene file; its particle file lies beside it
    std::string text;                   // text of the scene file when the recording began
    std::vector<std::string> overrides; // key=value, in the order in which they apply
    std::string server;                 // version of the server that recorded
    uint64_t tick = 0;                  // tick of the state that it begins with
    bool joined = false;                // True: that state came from other servers, and no replay can make it
};

struct RecordedTick {
    uint64_t tick = 0, state_hash = 0;
    std::vector<Command> commands;     // commands that this tick took, in order
    std::optional<uint64_t> frame;     // hash of the picture of the scene's own camera, 640x360
    std::string end;                   // reason why the recording ends here; empty: it goes on
    std::vector<RecordedError> errors; // known at this tick; a replay does not depend on them
};

// The text is one line: "FILE:LINE: what is wrong".
struct RecordingError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Appends records to a new file. Throws RecordingError if the file cannot be made or written.
class RecordingWriter {
public:
    // A file that exists already is renamed to FILE.old.
    RecordingWriter(const std::filesystem::path& file, const RecordingHead& head, uint64_t most_bytes = ~0ull);
    ~RecordingWriter();
    RecordingWriter(const RecordingWriter&) = delete;
    RecordingWriter& operator=(const RecordingWriter&) = delete;

    // Writes one record. Returns false and writes nothing if the file would exceed `most_bytes` or have no room for
    // its last line.
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

// Reads and verifies a recording. Throws RecordingError for a file that is no recording, has another version, was
// changed, or was cut within its first lines.
class RecordingReader {
public:
    explicit RecordingReader(const std::filesystem::path& file);

    const RecordingHead& head() const { return head_; }
    // Reads the next record; nothing at the end.
    std::optional<RecordedTick> next();
    // Valid at the end. True: the last line was incomplete and is left out; the server was killed while it wrote.
    bool cut() const { return cut_; }

private:
    std::optional<std::string> line(); // a complete line without its line end
    std::optional<std::string> verified();
    [[noreturn]] void fail(const std::string& what) const;

    const std::string file_;
    std::ifstream in_;
    size_t number_ = 0; // number of the line
    std::string hash_;
    RecordingHead head_;
    std::optional<uint64_t> last_tick_;
    bool cut_ = false, ended_ = false;
};

// `value` as 16 hexadecimal digits.
std::string hexOf(uint64_t value);

} // namespace brume
