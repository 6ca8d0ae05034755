// Watcher: a viewer for tests. It keeps every frame, error and state that it receives, and acknowledges frames.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/native/jpeg.h"
#include "client/native/session.h"
#include "tests/integration/process.h"

namespace brume::test {

struct Seen {
    uint32_t id = 0, pose_seq = 0;
    uint64_t tick = 0, state_hash = 0;
    int width = 0, height = 0;
    glm::vec3 position{0};
    int quality = 0;
    float render_ms = 0;                                     // until the device was done, as the server reports
    float measured = 0, measured_low = 0, measured_high = 0; // wire::Frame
    std::vector<client::Bytes> jpegs;                        // one for each view
    uint32_t layers = 0, layer_rows = 0;                     // of the first view, with depth
    std::vector<client::Bytes> layer_pictures;               // of that: colours, data, surface
};

struct SeenError {
    wire::ErrorCode code;
    std::string text;
    uint32_t input_seq;
};

inline const Pose kFromFront = lookAt({0, 2, 26}, {0, 0, 0}, 0.8f);
inline const client::Wishes kSmall{.width = 320, .height = 180, .views = 1, .quality = 80};

class Watcher {
public:
    // Connects and waits for the welcome. Throws std::runtime_error if none comes.
    explicit Watcher(const client::Endpoint& server, const client::Wishes& wishes = kSmall);

    // Sends a pose; returns its number.
    uint32_t look(const Pose& pose);
    // Receives messages until the time is over.
    void poll(milliseconds timeout);

    client::Session session;
    bool acknowledging = true; // False: frames are not acknowledged

    std::vector<Seen> frames;
    std::vector<SeenError> errors;
    std::map<uint64_t, uint64_t> hashes;   // state hash by tick, from frames and states
    std::optional<bool> paused;            // of the newest state
    uint64_t state_tick = 0;               // of the newest state
    float exposure = 0;                    // of the newest state
    std::string method;                    // that pictures are made with, of the newest state
    std::optional<uint32_t> viewers;       // of the newest state
    std::vector<std::vector<float>> lists; // Elements::values of the newest state that had them
    uint64_t lists_tick = 0;               // of that state
    std::optional<std::string> goodbye, go_to;

    // The newest frame. Throws std::out_of_range if there is none.
    const Seen& last() const { return frames.at(frames.size() - 1); }
    bool saw(wire::ErrorCode code) const;
};

// Polls all watchers in turn until the condition holds; false if it does not within `timeout`.
bool watch(const std::vector<Watcher*>& watchers, const std::function<bool()>& until, milliseconds timeout = kPatience);

// Pauses or resumes the shared simulation; returns a tick from which on it is paused or runs.
uint64_t setPaused(Watcher& watcher, bool paused, const std::vector<Watcher*>& others = {});

// Pairs of frames, one of each watcher, with the same tick; newest last.
std::vector<std::pair<const Seen*, const Seen*>> commonTicks(const Watcher& a, const Watcher& b,
                                                             uint64_t from_tick = 0);

// Decodes a JPEG. Throws std::runtime_error unless it is a complete JPEG of this size.
client::Picture decoded(const client::Bytes& jpeg, int width, int height);
client::Picture pictureOf(const Seen& frame, size_t view = 0);
// Mean absolute difference of all samples, in steps of 1/255. Precondition: equal sizes.
double difference(const client::Picture& a, const client::Picture& b);
// Standard deviation of the green samples, in steps of 1/255; near 0 for an empty picture.
double contrast(const client::Picture& picture);

} // namespace brume::test
