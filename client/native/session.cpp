#include "client/native/session.h"

#include <algorithm>
#include <utility>

#include "common/scene_limits.h"
#include "common/text.h"
#include "common/view_names.h"

namespace brume::client {
namespace {

wire::Vec3 toWire(glm::vec3 v) { return {v.x, v.y, v.z}; }
glm::vec3 fromWire(const wire::Vec3& v) { return {v.x(), v.y(), v.z()}; }
std::string textOf(const flatbuffers::String* text) { return text ? text->str() : std::string(); }

// Those that can be used; none where one of them cannot.
std::vector<CameraKey> keysOf(const wire::Welcome& welcome) {
    std::vector<CameraKey> keys;
    if (!welcome.path() || !limits::kCameraKeys.holds(double(welcome.path()->size()))) return keys;
    for (const wire::CameraKey* one : *welcome.path()) {
        const CameraKey key{fromWire(one->position()), fromWire(one->target()), one->fov_y(), one->seconds()};
        const bool timed = keys.empty() || limits::kKeySeconds.holds(double(key.seconds));
        const bool placed = isUsable(lookAt(key.position, key.target, key.fov_y));
        if (!timed || !placed) return {};
        keys.push_back(key);
    }
    return keys;
}

} // namespace

uint64_t nowUs() {
    using namespace std::chrono;
    return static_cast<uint64_t>(duration_cast<microseconds>(steady_clock::now().time_since_epoch()).count());
}

Session::Session(Endpoint endpoint, const Wishes& wishes, std::chrono::milliseconds timeout, std::string resume)
    : connection_(std::move(endpoint), timeout), wishes_(wishes), resume_(std::move(resume)) {}

Session::Session(Endpoint endpoint, const Wishes& wishes, std::chrono::milliseconds timeout, const Loop& loop,
                 std::string resume)
    : connection_(std::move(endpoint), timeout, loop), wishes_(wishes), resume_(std::move(resume)) {}

std::optional<Received> Session::next(std::chrono::milliseconds timeout) {
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    for (;;) {
        using std::chrono::milliseconds;
        const auto left = std::chrono::ceil<milliseconds>(deadline - std::chrono::steady_clock::now());
        std::optional<Bytes> bytes = connection_.receive(std::max(left, milliseconds(0)));
        if (!greeted_ && connection_.state() == Connection::State::open) sayHello();
        if (!bytes) {
            if (closed() || std::chrono::steady_clock::now() >= deadline) return {};
            continue;
        }
        const auto parsed = wire::parse(*bytes);
        if (!parsed) {
            refusal_ = "the server sent something that is not " + std::string(wire::kSubprotocol);
            connection_.close(milliseconds(200));
            return {};
        }
        Received message(std::move(*bytes), *parsed, nowUs());
        takeNote(message);
        if (message.type() != wire::Body::Ping && message.type() != wire::Body::Pong) return message;
    }
}

void Session::sayHello() {
    greeted_ = true;
    sendMessage([&](flatbuffers::FlatBufferBuilder& b) {
        const auto client = b.CreateString("brume-client " BRUME_VERSION);
        const auto resume = resume_.empty() ? 0 : b.CreateString(resume_);
        return wire::CreateHello(b, client, wishes_.width, wishes_.height, wishes_.views, wishes_.quality, resume,
                                 wishes_.lossless, wishes_.keep_size, wishes_.draw_hz);
    });
}

void Session::takeNote(const Received& message) {
    if (const auto* ping = message.as<wire::Ping>()) {
        sendMessage([&](auto& b) { return wire::CreatePong(b, ping->nonce(), ping->time_us()); });
    } else if (const auto* pong = message.as<wire::Pong>()) {
        if (pong->nonce() == ping_) round_trip_ms_ = static_cast<float>(message.receivedUs() - pong->time_us()) * 1e-3f;
    } else if (const auto* welcome = message.as<wire::Welcome>()) {
        const auto& camera = *welcome->camera();
        const glm::vec3 position = fromWire(*camera.position());
        glm::vec3 target = fromWire(*camera.target());
        if (!(glm::length(position - target) > 1e-3f)) target = position - glm::vec3(0, 0, 1); // any direction will do
        granted_ = Granted{welcome->viewer(),
                           textOf(welcome->server()),
                           textOf(welcome->scene()),
                           textOf(welcome->device()),
                           welcome->width(),
                           welcome->height(),
                           welcome->views(),
                           welcome->max_in_flight(),
                           welcome->tick_hz(),
                           position,
                           target,
                           camera.fov_y(),
                           textOf(welcome->resume()),
                           welcome->resumed(),
                           keysOf(*welcome),
                           welcome->people()};
        if (welcome->people()) sayPresence();
    } else if (const auto* people = message.as<wire::People>()) {
        meet(*people);
    } else if (const auto* state = message.as<wire::SceneState>()) {
        standstill_ = oneLine(textOf(state->standstill()));
    } else if (const auto* error = message.as<wire::Error>()) {
        if (!welcomed()) refusal_ = "the server refuses: " + oneLine(textOf(error->text()));
    } else if (const auto* goodbye = message.as<wire::Goodbye>()) {
        if (refusal_.empty()) refusal_ = "the server says goodbye: " + oneLine(textOf(goodbye->reason()));
        const float wait_s = goodbye->retry_after_s();
        retry_after_s_ = wait_s > 0 ? std::min(wait_s, 3600.0f) : 0; // NaN is 0
        go_to_ = textOf(goodbye->go_to());
        connection_.close(std::chrono::milliseconds(200));
    }
}

void Session::sayPresence() {
    std::optional<wire::Ray> ray;
    if (const auto& pointer = appearance_.pointer) ray.emplace(toWire(pointer->origin), toWire(pointer->direction));
    sendMessage([&](auto& b) {
        return wire::CreatePresenceDirect(b, wishes_.name.c_str(), ray ? &*ray : nullptr, follow_, appearance_.cameras);
    });
}

void Session::appear(const Appearance& appearance) {
    if (!granted().people || appearance == appearance_) return;
    appearance_ = appearance;
    sayPresence();
}

// Follows who has the wished name, as long as they are here.
void Session::meet(const wire::People& people) {
    if (!welcomed()) return;
    uint32_t wanted = 0, led_by = people.presenter();
    for (const wire::Person* one : *people.people()) {
        if (!wishes_.follow.empty() && wanted == 0 && one->name()->str() == wishes_.follow) wanted = one->id();
        if (led_by == 0 && one->id() == granted().viewer) led_by = one->follows();
    }
    leader_.clear();
    for (const wire::Person* one : *people.people())
        if (one->id() == led_by && led_by != granted().viewer) leader_ = oneLine(one->name()->str());
    if (wanted != std::exchange(follow_, wanted)) sayPresence();
}

std::string Session::closedBecause() const { return refusal_.empty() ? connection_.closedBecause() : refusal_; }

std::optional<uint32_t> Session::sendPose(const Pose& pose, uint16_t width, uint16_t height, bool hidden,
                                          uint8_t layers) {
    constexpr size_t enough_unsent = 4; // more would only grow old
    if (connection_.unsent() >= enough_unsent) return {};
    const uint32_t seq = ++pose_seq_;
    const wire::Vec3 position = toWire(pose.position);
    const glm::quat& q = pose.orientation;
    const wire::Quat orientation(q.x, q.y, q.z, q.w);
    sendMessage([&](auto& b) {
        flatbuffers::Offset<flatbuffers::String> view; // none: the picture
        if (wishes_.view != kViewNames[0]) view = b.CreateString(wishes_.view);
        return wire::CreatePose(b, seq, nowUs(), &position, &orientation, pose.fov_y, pose.eye_separation, width,
                                height, nullptr, nullptr, hidden, view, layers);
    });
    return seq;
}

uint32_t Session::sendImpulse(const Impulse& impulse) {
    const wire::Vec3 origin = toWire(impulse.origin), direction = toWire(impulse.direction),
                     along = toWire(impulse.push);
    return sendCommand<wire::Impulse>(
        [&](auto& b) { return wire::CreateImpulse(b, &origin, &direction, &along, impulse.strength); });
}

uint32_t Session::sendPaused(bool paused) {
    return sendCommand<wire::Set>([&](auto& b) {
        const std::vector changes{wire::CreateChangeDirect(b, "simulation.paused", paused)};
        return wire::CreateSetDirect(b, &changes);
    });
}

uint32_t Session::sendUndo() {
    return sendCommand<wire::Undo>([](auto& b) { return wire::CreateUndo(b); });
}

void Session::acknowledge(uint32_t frame) {
    sendMessage([&](auto& b) { return wire::CreateAck(b, frame); });
}

void Session::sendPing() {
    sendMessage([&](auto& b) { return wire::CreatePing(b, ++ping_, nowUs()); });
}

void Session::leave(const std::string& reason, std::chrono::milliseconds deadline) {
    if (greeted_) sendMessage([&](auto& b) { return wire::CreateGoodbye(b, b.CreateString(reason)); });
    connection_.close(deadline);
}

} // namespace brume::client
