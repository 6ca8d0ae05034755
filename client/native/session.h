// A viewer's session with a server: hello and welcome, poses and inputs out, verified messages in. For one thread.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/native/camera_path.h"
#include "client/native/connection.h"
#include "common/camera_keys.h"
#include "protocol/message.h"

namespace brume::client {

// Microseconds of this client's own monotonic clock: the client_time_us of every message.
uint64_t nowUs();

// A verified message together with the bytes that it points into.
class Received {
public:
    Received(Bytes bytes, wire::Parsed parsed, uint64_t received_us)
        : bytes_(std::move(bytes)), parsed_(std::move(parsed)), received_us_(received_us) {}
    Received(Received&&) noexcept = default; // a moved vector keeps its memory, so `parsed_` stays right
    Received& operator=(Received&&) noexcept = default;

    wire::Body type() const { return parsed_.type(); }
    // Null when the message is of another type.
    template <class T>
    const T* as() const {
        return parsed_.as<T>();
    }
    const wire::Parsed& parsed() const { return parsed_; }
    size_t size() const { return bytes_.size(); }
    uint64_t receivedUs() const { return received_us_; }

private:
    Bytes bytes_;
    wire::Parsed parsed_;
    uint64_t received_us_;
};

struct Wishes {                         // what a viewer asks for in its hello
    uint16_t width = 640, height = 360; // pixels of one eye's picture
    uint8_t views = 1;                  // 2 for left and right eye
    uint8_t quality = 0;                // JPEG, 0 = the server's
    bool lossless = true;               // true: a still picture comes once more, as PNG
    bool keep_size = false;             // true: pictures come more seldom, not smaller
    uint8_t draw_hz = 0;                // above 0: lit particles, so many a second, in place of pictures
    std::string view = "picture";       // the view of how it is made, a name of view_names.h
    std::string name;                   // name that others see; empty: the token's, or one that the server finds
    std::string follow;                 // name of the person whose camera pictures have, once it is here; empty: none
};

// What a welcome grants.
struct Granted {
    uint32_t viewer = 0;
    std::string server, scene, device;
    uint16_t width = 0, height = 0;
    uint8_t views = 1, max_in_flight = 1;
    float tick_hz = 0;
    glm::vec3 position{0}, target{0}; // the scene's own camera
    float fov_y = 0.8f;
    std::string resume;   // a secret key: with it, a new session within a minute of losing this one is the same viewer
    bool resumed = false; // true: the server knew the key that the hello named
    std::vector<CameraKey> keys; // the scene's key views; empty: it has none, or the server is older
    bool people = false;         // true: the server knows of people
};

// What a viewer says of itself to others, beside its name.
struct Appearance {
    std::optional<Ray> pointer; // along which it points; nothing: it points at nothing
    bool cameras = false;       // true: it wants to know where others look from
    bool operator==(const Appearance&) const = default;
};

// Pushes the particles near a ray (wire::Impulse): along `push`, in m/s, or away from the ray when that is zero.
struct Impulse {
    glm::vec3 origin{0}, direction{0, 0, -1}, push{0};
    float strength = 1;
};

class Session {
public:
    // `resume` is Granted::resume of a connection that was lost, or empty.
    Session(Endpoint endpoint, const Wishes& wishes, std::chrono::milliseconds timeout, std::string resume = {});
    // Likewise, in a loop that other sessions share (connection.h).
    Session(Endpoint endpoint, const Wishes& wishes, std::chrono::milliseconds timeout, const Loop& loop,
            std::string resume = {});

    // The next message, or nothing when none comes in time. Sends the hello, answers pings, and reads welcome, errors
    // and goodbye for the functions below. Pings and pongs are not returned, all other messages are.
    std::optional<Received> next(std::chrono::milliseconds timeout);

    bool welcomed() const { return granted_.has_value(); }
    // Precondition: welcomed().
    const Granted& granted() const { return *granted_; }

    bool closed() const { return connection_.state() == Connection::State::closed; }
    // One line: the server's goodbye or refusal if it sent one, otherwise the socket's error.
    std::string closedBecause() const;
    // True if another try would end the same way: Connection::refused(), or the server refused before the welcome.
    bool refused() const { return connection_.refused() || (!refusal_.empty() && !welcomed()); }
    // The wait, in seconds, that the server's goodbye asks for; 0 without one.
    float retryAfterSeconds() const { return retry_after_s_; }
    // Why the scene stands still, in one line; empty while ticks come.
    const std::string& standstill() const { return standstill_; }
    // Name of the person whose camera pictures have; empty: the viewer's own.
    const std::string& leader() const { return leader_; }
    // The URL of another server that the goodbye names, unchecked; empty without one.
    const std::string& goTo() const { return go_to_; }

    // Sends a pose, or nothing while the socket has not taken earlier ones, since only the newest pose counts.
    // Returns the pose's number if it was sent. A size of 0 keeps the last size. `hidden`: true when nobody sees the
    // pictures; the server then sends none until a pose without it.
    std::optional<uint32_t> sendPose(const Pose& pose, uint16_t width = 0, uint16_t height = 0, bool hidden = false,
                                     uint8_t layers = 0);
    // Sends an input; none is ever left out. `build` returns the offset of the command's table. Returns the input's
    // number.
    template <class Command, class Build>
    uint32_t sendCommand(Build&& build) {
        const uint32_t seq = ++input_seq_;
        sendMessage([&](flatbuffers::FlatBufferBuilder& b) {
            const flatbuffers::Offset<Command> command = build(b);
            return wire::CreateInput(b, seq, nowUs(), wire::CommandTraits<Command>::enum_value, command.Union());
        });
        return seq;
    }
    uint32_t sendImpulse(const Impulse& impulse);
    uint32_t sendPaused(bool paused);
    uint32_t sendUndo(); // takes back the newest change of anybody
    // Says it if it is new, and the server knows of people. Precondition: welcomed().
    void appear(const Appearance& appearance);
    // Tells the server that the frame was presented or dropped: it may send another.
    void acknowledge(uint32_t frame);
    void sendPing();
    // Round trip of the newest answered ping; nothing before the first answer.
    std::optional<float> roundTripMs() const { return round_trip_ms_; }

    // Sends a goodbye and the closing handshake, and waits for the server's at most `deadline`.
    void leave(const std::string& reason, std::chrono::milliseconds deadline = std::chrono::milliseconds(500));

    Connection& connection() { return connection_; }

private:
    template <class Build>
    void sendMessage(Build&& build) {
        connection_.send(wire::bytesOf(wire::pack(build)));
    }
    void sayHello();
    void takeNote(const Received& message);
    void sayPresence();
    void meet(const wire::People& people);

    Connection connection_;
    Wishes wishes_;
    std::string resume_;
    bool greeted_ = false;
    std::optional<Granted> granted_;
    std::string refusal_; // text of a goodbye, or of an error before the welcome
    float retry_after_s_ = 0;
    std::string go_to_, standstill_, leader_;
    uint32_t follow_ = 0; // id of the person that was asked for
    Appearance appearance_;
    uint32_t pose_seq_ = 0, input_seq_ = 0, ping_ = 0;
    std::optional<float> round_trip_ms_;
};

} // namespace brume::client
