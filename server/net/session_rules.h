// Which messages a viewer may send when, and what follows from each: a state machine without sockets, threads or clock.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "server/net/access.h"
#include "server/net/commands.h"
#include "server/net/options.h"
#include "server/net/rate.h"
#include "server/viewer/audience.h"

namespace brume::net {

// --- actions, which the session carries out in order ---
struct Admit { // the hello is good: join the audience, then send Welcome, or close if it is full
    std::string client;
    PoseRequest granted; // size, views and quality
    std::string resume;  // the key of a connection that was lost; empty for a new viewer
};
struct SetPose { // the pose to render from now on
    PoseRequest request;
};
struct SetPresence { // what the viewer says of itself from now on
    Presence presence;
};
struct TakeLead {    // all take this person's camera; if there is no such person, call SessionRules::onUnknownPerson
    uint32_t person; // 0: nobody's
};
struct EnqueueCommand { // a command for the scene; answer busy if the queue refuses it
    uint32_t seq;
    CommandBody body;
};
struct Acknowledge { // a frame has arrived; if it was never sent, call SessionRules::onUnknownFrame
    uint32_t frame;
};
struct AnswerPing {
    uint32_t nonce;
    uint64_t time_us;
};
struct Ponged { // the answer to a ping, if one with this number was sent
    uint32_t nonce;
};
struct SendError {
    wire::ErrorCode code;
    std::string text;
    uint32_t input_seq = 0; // of the input that is refused; 0: of none
};
struct Close { // send Goodbye with the reason and close with this WebSocket code; no action follows
    uint16_t code;
    std::string reason;
};
using Action = std::variant<Admit, SetPose, SetPresence, TakeLead, EnqueueCommand, Acknowledge, AnswerPing, Ponged,
                            SendError, Close>;
using Actions = std::vector<Action>;

// WebSocket close codes (RFC 6455 and the IANA registry).
inline constexpr uint16_t kCloseNormal = 1000, kCloseGoingAway = 1001, kCloseProtocol = 1002, kClosePolicy = 1008,
                          kCloseTryLater = 1013;

class SessionRules {
public:
    // `options` and `facts` outlive the rules.
    SessionRules(const NetOptions& options, const ServerFacts& facts, Clock::time_point opened,
                 const Authorization& authorization = {});

    // The viewer was told that this medium is shown. Until then commands that name its particles are refused.
    void shows(const NamedParticles& medium) { medium_ = medium; }

    // Each appends its actions to `out`. Precondition: bytes.data() is aligned to 8.
    void onMessage(std::span<const uint8_t> bytes, Clock::time_point now, Actions& out);
    void onText(Clock::time_point now, Actions& out); // a text message: brume.v1 has only binary ones
    void onUnknownFrame(uint32_t frame, Clock::time_point now, Actions& out);
    void onUnknownPerson(uint32_t person, Clock::time_point now, Actions& out);
    // So many WebSocket frames that are no message came: pings, pongs, fragments. Each counts as one message.
    void onMereFrames(uint64_t count, Clock::time_point now, Actions& out);
    // Checks deadlines and hands out a pose or a presence that was held back. To be called several times a second.
    void onTick(Clock::time_point now, Actions& out);

    // How long to wait before the next message is read: zero unless the viewer sends more than options.message_rate.
    Clock::duration pause(Clock::time_point now) { return messages_.wait(now); }

private:
    void onHello(const wire::Hello& hello, Clock::time_point now, Actions& out);
    void onPose(const wire::Pose& pose, Clock::time_point now, Actions& out);
    void onInput(const wire::Input& input, Clock::time_point now, Actions& out);
    void onPresence(const wire::Presence& presence, Clock::time_point now, Actions& out);
    void onLead(const wire::Lead& lead, Clock::time_point now, Actions& out);
    void malformed(const std::string& text, Clock::time_point now, Actions& out);
    void refuse(wire::ErrorCode code, std::string text, Clock::time_point now, Actions& out, uint32_t input_seq = 0);
    void close(uint16_t code, std::string reason, Actions& out);

    enum class State { awaiting_hello, watching, closed };

    const NetOptions& options_;
    const ServerFacts& facts_;
    NamedParticles medium_;
    const Clock::time_point hello_deadline_;
    std::optional<Clock::time_point> pose_deadline_; // from Hello until the first good pose
    const Role role_;
    const std::optional<Clock::time_point> until_; // when the token ends
    State state_ = State::awaiting_hello;
    PoseRequest granted_;                  // the present size, views and quality
    std::optional<PoseRequest> postponed_; // the newest pose over the rate: set at a later tick
    std::optional<Presence> postponed_presence_;
    std::optional<uint32_t> input_seq_; // of the last input
    int malformed_ = 0;
    TokenBucket messages_, poses_, inputs_, presences_, pose_complaints_, refusals_;
};

} // namespace brume::net
