#include "server/net/session_rules.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "common/scene_limits.h"
#include "common/view_names.h"
#include "server/net/convert.h"
#include "server/net/picture_size.h"

namespace brume::net {
namespace {

constexpr size_t kLongestKey = 64; // bytes of a key to resume with; further bytes are ignored
constexpr uint8_t kMostDrawHz = 60;
constexpr int kMaxMalformed = 3; // malformed messages until the connection is closed: it speaks another protocol
// Refusals a second, and in a burst. A viewer with a bug is told of each; one that exceeds them is disconnected.
constexpr double kRefusalRate = 50, kRefusalBurst = 200;
// What viewers say of themselves a second; more of it comes at this rate, the last at the end.
constexpr double kPresenceRate = 20, kPresenceBurst = 20;

double seconds(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }

// A viewer's name for the log: at most 64 printable ASCII characters.
std::string printable(const flatbuffers::String* text) {
    std::string out = text ? text->str().substr(0, 64) : "unnamed";
    std::replace_if(
        out.begin(), out.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
    return out;
}

} // namespace

SessionRules::SessionRules(const NetOptions& options, const ServerFacts& facts, Clock::time_point opened,
                           const Authorization& authorization)
    : options_(options), facts_(facts), hello_deadline_(opened + options.handshake), role_(authorization.role),
      until_(authorization.until), messages_(options.message_rate, options.message_rate * options.burst_s),
      poses_(options.pose_rate, options.pose_rate * options.burst_s),
      inputs_(options.input_rate, options.input_rate * options.burst_s), presences_(kPresenceRate, kPresenceBurst),
      pose_complaints_(1, 1), refusals_(kRefusalRate, kRefusalBurst) {}

void SessionRules::onMessage(std::span<const uint8_t> bytes, Clock::time_point now, Actions& out) {
    if (state_ == State::closed) return;
    messages_.take(now); // pause() says how long to wait if the bucket is empty
    const auto message = wire::parse(bytes);
    if (!message) return malformed("not a message of brume.v1: " + wire::whyNot(bytes), now, out);

    // Messages that are allowed at any time.
    if (const auto* ping = message->as<wire::Ping>()) {
        out.push_back(AnswerPing{ping->nonce(), ping->time_us()});
        return;
    }
    if (const auto* pong = message->as<wire::Pong>()) {
        out.push_back(Ponged{pong->nonce()});
        return;
    }
    if (message->as<wire::Goodbye>()) return close(kCloseNormal, "the viewer said goodbye", out);
    if (const auto* hello = message->as<wire::Hello>()) return onHello(*hello, now, out);

    // Messages that are allowed after Hello.
    const bool watching = state_ == State::watching;
    if (const auto* pose = message->as<wire::Pose>(); pose && watching) return onPose(*pose, now, out);
    if (const auto* input = message->as<wire::Input>(); input && watching) return onInput(*input, now, out);
    if (const auto* presence = message->as<wire::Presence>(); presence && watching)
        return onPresence(*presence, now, out);
    if (const auto* lead = message->as<wire::Lead>(); lead && watching) return onLead(*lead, now, out);
    if (const auto* ack = message->as<wire::Ack>(); ack && watching) {
        out.push_back(Acknowledge{ack->frame()});
        return;
    }
    refuse(wire::ErrorCode::unexpected,
           fmt::format("{} {}", wire::EnumNameBody(message->type()),
                       watching ? "is the server's to send" : "came before Hello"),
           now, out);
}

void SessionRules::onText(Clock::time_point now, Actions& out) {
    if (state_ == State::closed) return;
    messages_.take(now);
    malformed("messages are binary, this was text", now, out);
}

void SessionRules::onUnknownFrame(uint32_t frame, Clock::time_point now, Actions& out) {
    if (state_ == State::closed) return;
    refuse(wire::ErrorCode::unexpected, fmt::format("frame {} was never sent", frame), now, out);
}

void SessionRules::onUnknownPerson(uint32_t person, Clock::time_point now, Actions& out) {
    if (state_ == State::closed) return;
    refuse(wire::ErrorCode::unknown_name, fmt::format("person {} is not here", person), now, out);
}

void SessionRules::onMereFrames(uint64_t count, Clock::time_point now, Actions& out) {
    if (state_ != State::closed && !messages_.charge(double(count), now))
        close(kClosePolicy, "too many WebSocket pings or fragments", out);
}

void SessionRules::onTick(Clock::time_point now, Actions& out) {
    if (state_ != State::closed && until_ && now >= *until_) return close(kClosePolicy, "the token has expired", out);
    if (state_ == State::awaiting_hello && now >= hello_deadline_)
        return close(kClosePolicy, fmt::format("no Hello came within {:g} s", seconds(options_.handshake)), out);
    if (state_ == State::watching && pose_deadline_ && now >= *pose_deadline_)
        return close(kClosePolicy,
                     fmt::format("no Pose came within {:g} s of Hello: send one, hidden where nothing is to be drawn",
                                 seconds(options_.handshake)),
                     out);
    if (state_ == State::watching && postponed_ && poses_.take(now)) {
        out.push_back(SetPose{*postponed_});
        postponed_.reset();
    }
    if (state_ == State::watching && postponed_presence_ && presences_.take(now))
        out.push_back(SetPresence{*std::exchange(postponed_presence_, std::nullopt)});
}

void SessionRules::onHello(const wire::Hello& hello, Clock::time_point now, Actions& out) {
    if (state_ == State::watching) return refuse(wire::ErrorCode::unexpected, "Hello came twice", now, out);
    if (hello.width() == 0 || hello.height() == 0)
        return refuse(wire::ErrorCode::out_of_range, "width and height must be at least 1", now, out);
    if (hello.views() < 1 || hello.views() > wire::kMaxViews)
        return refuse(wire::ErrorCode::out_of_range, "views must be 1 or 2", now, out);
    if (hello.draw_hz() > kMostDrawHz)
        return refuse(wire::ErrorCode::out_of_range, fmt::format("draw_hz must be 0 ... {}", kMostDrawHz), now, out);
    if (hello.quality() > 100) return refuse(wire::ErrorCode::out_of_range, "quality must be 0 ... 100", now, out);

    const PictureSize size = fitSize({hello.width(), hello.height()}, options_);
    granted_.width = size.width;
    granted_.height = size.height;
    granted_.views = hello.views();
    granted_.draw_hz = hello.draw_hz();
    granted_.takes_png = hello.lossless();
    granted_.keeps_size = hello.keep_size();
    granted_.quality = hello.quality() == 0 ? options_.default_quality : hello.quality();
    state_ = State::watching;
    pose_deadline_ = now + options_.handshake;
    out.push_back(
        Admit{printable(hello.client()), granted_, hello.resume() ? hello.resume()->str().substr(0, kLongestKey) : ""});
}

void SessionRules::onPose(const wire::Pose& pose, Clock::time_point now, Actions& out) {
    Pose wanted{.position = toGlm(*pose.position()),
                .orientation = toGlm(*pose.orientation()),
                .fov_y = pose.fov_y(),
                .eye_separation = pose.eye_separation()};
    if (!isUsable(wanted))
        return refuse(wire::ErrorCode::out_of_range,
                      fmt::format("a pose has finite numbers, a unit orientation, fov_y in 0.01 ... 3.1 and "
                                  "eye_separation in {} ... {} m",
                                  limits::kEyeSeparation.lo, limits::kEyeSeparation.hi),
                      now, out);
    for (int i = 0; i < 3; ++i)
        if (!limits::kPlace.holds(wanted.position[i]))
            return refuse(wire::ErrorCode::out_of_range,
                          fmt::format("position must be {} ... {}", limits::kPlace.lo, limits::kPlace.hi), now, out);
    if (pose.frustum()) wanted.frustum = toFrustum(*pose.frustum());
    if (pose.right_frustum()) wanted.right_frustum = toFrustum(*pose.right_frustum());
    if (!isUsable(wanted.frustum) || !isUsable(wanted.right_frustum))
        return refuse(wire::ErrorCode::out_of_range,
                      "a frustum has tangents in -50 ... 50, left + right and up + down at least 0.01", now, out);
    const auto view = viewNamed(pose.view() ? pose.view()->string_view() : kViewNames[0]);
    if (!view) return refuse(wire::ErrorCode::out_of_range, "no such view; there are " + allViewNames(), now, out);
    wanted.orientation = glm::normalize(wanted.orientation);
    pose_deadline_.reset();

    if (pose.width() != 0 || pose.height() != 0) {
        const PictureSize size = fitSize(
            {pose.width() != 0 ? pose.width() : granted_.width, pose.height() != 0 ? pose.height() : granted_.height},
            options_);
        granted_.width = size.width;
        granted_.height = size.height;
    }
    if (pose.layers() > wire::kMaxLayers)
        return refuse(wire::ErrorCode::out_of_range, fmt::format("layers are 0 ... {}", wire::kMaxLayers), now, out);
    PoseRequest request = granted_;
    request.layers = pose.layers();
    request.seq = pose.seq();
    request.client_time_us = pose.client_time_us();
    request.pose = wanted;
    request.hidden = pose.hidden();
    request.show = *view;
    request.received = now;

    if (postponed_ && int32_t(request.seq - postponed_->seq) <= 0) return; // older than the pose that waits
    if (poses_.take(now)) {
        postponed_.reset();
        out.push_back(SetPose{request});
        return;
    }
    postponed_ = request;
    if (pose_complaints_.take(now))
        out.push_back(
            SendError{wire::ErrorCode::too_fast, fmt::format("more than {:g} poses a second", options_.pose_rate)});
}

void SessionRules::onInput(const wire::Input& input, Clock::time_point now, Actions& out) {
    const uint32_t seq = input.seq();
    if (input_seq_ && seq != *input_seq_ + 1) {
        const uint32_t due = *input_seq_ + 1;
        if (int32_t(seq - due) > 0) input_seq_ = seq; // after a gap counting goes on from here
        return refuse(wire::ErrorCode::unexpected, fmt::format("input {} came where {} was due", seq, due), now, out,
                      seq);
    }
    input_seq_ = seq;
    if (!inputs_.take(now))
        return refuse(wire::ErrorCode::too_fast, fmt::format("more than {:g} inputs a second", options_.input_rate),
                      now, out, seq);

    auto command = readCommand(input, facts_, medium_, role_);
    if (auto* refusal = std::get_if<Refusal>(&command))
        return refuse(refusal->code, std::move(refusal->text), now, out, seq);
    out.push_back(EnqueueCommand{seq, std::get<CommandBody>(std::move(command))});
}

void SessionRules::onPresence(const wire::Presence& said, Clock::time_point now, Actions& out) {
    Presence presence{.name = personName(said.name() ? said.name()->string_view() : ""),
                      .pointer = {},
                      .follow = said.follow(),
                      .cameras = said.cameras()};
    if (const wire::Ray* ray = said.pointer()) {
        const glm::vec3 origin = toGlm(ray->origin()), direction = toGlm(ray->direction());
        const float length = glm::length(direction);
        const auto holds = [](float place) { return limits::kPlace.holds(place); };
        if (!holds(origin.x) || !holds(origin.y) || !holds(origin.z) || !(length > 1e-6f && length < 1e6f))
            return refuse(wire::ErrorCode::out_of_range,
                          fmt::format("a pointer begins at {} ... {} m and has a direction of finite length above 0",
                                      limits::kPlace.lo, limits::kPlace.hi),
                          now, out);
        presence.pointer = PointingRay{origin, direction / length};
    }
    postponed_presence_ = std::move(presence);
    if (!presences_.take(now)) return;
    out.push_back(SetPresence{*std::exchange(postponed_presence_, std::nullopt)});
}

void SessionRules::onLead(const wire::Lead& lead, Clock::time_point now, Actions& out) {
    if (!atLeast(role_, Role::presenter))
        return refuse(wire::ErrorCode::forbidden, forbidden(role_, Role::presenter), now, out);
    if (!presences_.take(now))
        return refuse(wire::ErrorCode::too_fast, fmt::format("more than {:g} such messages a second", kPresenceRate),
                      now, out);
    out.push_back(TakeLead{lead.person()});
}

void SessionRules::malformed(const std::string& text, Clock::time_point now, Actions& out) {
    refuse(wire::ErrorCode::malformed, text, now, out);
    if (state_ != State::closed && ++malformed_ >= kMaxMalformed)
        close(kCloseProtocol, fmt::format("{} malformed messages", kMaxMalformed), out);
}

void SessionRules::refuse(wire::ErrorCode code, std::string text, Clock::time_point now, Actions& out,
                          uint32_t input_seq) {
    out.push_back(SendError{code, std::move(text), input_seq});
    if (!refusals_.take(now)) close(kClosePolicy, "too many refused messages", out);
}

void SessionRules::close(uint16_t code, std::string reason, Actions& out) {
    state_ = State::closed;
    out.push_back(Close{code, std::move(reason)});
}

} // namespace brume::net
