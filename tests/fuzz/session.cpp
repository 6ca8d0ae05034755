// An input is a sequence of records: kind, a wait, and what the kind has. Whole messages as they are; and messages made
// of the fuzzer's numbers, which reach behind the verifier.
#include <cmath>
#include <string>
#include <vector>

#include "common/scene_limits.h"
#include "server/net/picture_size.h"
#include "server/net/session_rules.h"
#include "tests/fuzz/promise.h"

namespace brume::fuzz {
namespace {

using net::NetOptions;
using std::chrono::microseconds;

enum Kind : uint8_t { kBytes, kHello, kPose, kInput, kAck, kText, kTick, kUnknownFrame, kPing, kPong, kKinds };

bool isDrawable(const Frustum& f) { // all zero: the symmetric one of fov_y
    if (f == Frustum{}) return true;
    for (const float tangent : {f.left, f.right, f.up, f.down})
        if (!(std::abs(tangent) <= 50)) return false;
    return f.left + f.right >= 0.01f && f.up + f.down >= 0.01f;
}
bool isDirection(glm::vec3 v) { return within(v, limits::kPlace) && glm::length(v) > 1e-6f; }

// Holds every action against what the rest of the server counts on.
class Judge {
public:
    Judge(const NetOptions& options, const ServerFacts& facts, const net::NamedParticles& medium,
          Clock::time_point opened)
        : options_(options), facts_(facts), medium_(medium), opened_(opened) {}

    void judge(const net::Actions& actions, Clock::time_point now) {
        promise(actions.size() <= 2, "one event has two actions at most: an answer and the end");
        now_ = now;
        for (const net::Action& action : actions) {
            promise(!closed_, "nothing follows a Close");
            std::visit(*this, action);
        }
    }

    void operator()(const net::Admit& e) {
        promise(!admitted_, "a viewer is admitted once");
        admitted_ = true;
        promiseOneLine(e.client.empty() ? "empty" : e.client, 64);
        promise(e.resume.size() <= 64, "a key is no longer than any that was given");
        picture(e.granted);
    }
    void operator()(const net::SetPose& e) {
        promise(admitted_, "no pose before Hello");
        picture(e.request);
        const Pose& pose = e.request.pose;
        promise(isUsable(pose) && within(pose.position, limits::kPlace), "a pose is usable");
        promise(std::abs(glm::length(pose.orientation) - 1) < 1e-3f, "an orientation is unit");
        promise(isDrawable(pose.frustum) && isDrawable(pose.right_frustum),
                "a frustum shows something, and not all around");
        promise(pose.eye_separation >= 0 && pose.eye_separation <= 10, "eyes stand apart as people's, or giants'");
        promise(double(++shows_) <= allowance(options_.pose_rate), "poses keep to their rate");
    }
    void operator()(const net::EnqueueCommand& e) {
        promise(admitted_, "no input before Hello");
        promise(double(++pushes_) <= allowance(options_.input_rate), "inputs keep to their rate");
        std::visit(*this, e.body);
    }
    void operator()(const net::Acknowledge&) const { promise(admitted_, "no Ack before Hello"); }
    void operator()(const net::SendError& e) {
        promise(e.code >= wire::ErrorCode::MIN && e.code <= wire::ErrorCode::MAX, "an error code that viewers know");
        promiseOneLine(e.text, 256);
    }
    void operator()(const net::Close& e) {
        closed_ = true;
        promise(e.code == net::kCloseNormal || e.code == net::kCloseProtocol || e.code == net::kClosePolicy,
                "a known close code");
        promiseOneLine(e.reason, 123); // what a close frame holds
    }

    void operator()(const Impulse& c) {
        promise(within(c.origin, limits::kPlace) && isDirection(c.direction) && within(c.push, limits::kSpeed) &&
                    limits::kStrength.holds(c.strength),
                "an impulse within limits");
    }
    void operator()(const MoveVolume& c) { promise(within(c.offset, limits::kPlace), "a move within limits"); }
    void operator()(const Set& c) {
        for (const Change& change : c.changes)
            promise(change.setting->in_list == (change.element != kNoElement), "an element, where it is of one");
        areAllowed(c.changes);
    }
    void operator()(const Add& c) {
        for (const Change& change : c.changes)
            promise(elementSetting(c.list, change.setting->path) && change.element == kNoElement, "of the new element");
        areAllowed(c.changes);
    }
    void operator()(const SetParticles& c) {
        promise(problemOf(c, medium_.rows).empty(), "rows of particles within limits");
    }
    // What holds no more than a number or a name of its own.
    template <class Other>
    void operator()(const Other&) {}

private:
    void areAllowed(const std::vector<Change>& changes) const {
        for (const Change& change : changes) {
            promise(change.setting != nullptr && change.setting->live(), "a setting that is live");
            std::visit([&](const auto& value) { allowed(*change.setting, value); }, change.value);
        }
    }
    void allowed(const SceneSetting&, bool) const {}
    void allowed(const SceneSetting& setting, float value) const {
        promise(setting.allowed.holds(value), "a number within limits");
    }
    void allowed(const SceneSetting& setting, uint32_t value) const {
        promise(setting.allowed.holds(value), "a number within limits");
    }
    void allowed(const SceneSetting& setting, const glm::vec3& value) const {
        promise(setting.form == Form::direction ? isDirection(value) : within(value, setting.allowed),
                "a vector within limits");
    }
    void allowed(const SceneSetting& setting, const std::string& value) const {
        const std::vector<std::string> names = facts_.choicesOf(setting);
        promise(std::find(names.begin(), names.end(), value) != names.end(), "a name that there is");
    }
    void picture(const PoseRequest& request) const {
        promise(request.width >= net::kMinSide && request.height >= net::kMinSide &&
                    request.width <= options_.max_side && request.height <= options_.max_side,
                "a picture's sides within limits");
        promise(uint32_t(request.width) * request.height <= options_.max_pixels, "a picture's pixels within limits");
        promise(request.views == 1 || request.views == 2, "one eye or two");
        promise(request.quality >= 1 && request.quality <= 100, "a quality that JPEG has");
    }
    double allowance(double rate) const {
        return rate * (options_.burst_s + std::chrono::duration<double>(now_ - opened_).count()) + 1;
    }

    const NetOptions& options_;
    const ServerFacts& facts_;
    const net::NamedParticles medium_;
    const Clock::time_point opened_;
    Clock::time_point now_;
    bool admitted_ = false, closed_ = false;
    uint64_t shows_ = 0, pushes_ = 0;
};

// A small number, which most rules let through, or any bits.
float number(Numbers& in) {
    const auto kind = in.take<uint8_t>();
    return kind == 255 ? in.take<float>() : float(kind - 100) / 16;
}
wire::Vec3 vector(Numbers& in) {
    const float x = number(in), y = number(in), z = number(in);
    return {x, y, z};
}
std::string name(Numbers& in, const std::string& known) {
    const auto length = in.take<uint8_t>();
    return length == 0 ? known : std::string(textOf(in.bytes(length)));
}

using Builder = flatbuffers::FlatBufferBuilder;

// A command of the fuzzer's numbers.
wire::Packed input(Numbers& in, const ServerFacts& facts) {
    return wire::pack([&](Builder& b) {
        const uint32_t which = in.take<uint8_t>(), seq = in.take<uint8_t>();
        const auto as = [&]<class Command>(flatbuffers::Offset<Command> command) {
            return wire::CreateInput(b, seq, 0, wire::CommandTraits<Command>::enum_value, command.Union());
        };
        const wire::Vec3 one = vector(in), two = vector(in), three = vector(in);
        const float a = number(in), c = number(in), d = number(in), e = number(in);
        if (which >= 250) {
            const auto all = sceneSettings();
            const SceneSetting& setting = all[in.take<uint8_t>() % all.size()];
            std::string path(setting.path);
            if (setting.in_list && which != 254) path.insert(path.find('.'), '[' + name(in, "0") + ']');
            const auto text = name(in, facts.methods[0]);
            const std::vector changes{
                wire::CreateChangeDirect(b, path.c_str(), a, which % 2 ? &one : nullptr, text.c_str())};
            if (which == 255) return as(wire::CreateRemoveDirect(b, path.substr(0, path.find('.')).c_str()));
            if (which == 254) return as(wire::CreateAddDirect(b, std::string(setting.table()).c_str(), &changes));
            return as(wire::CreateSetDirect(b, &changes));
        }
        if (which >= 240) {
            const std::vector<float> positions(in.take<uint8_t>(), a), each(in.take<uint8_t>(), c);
            const uint32_t first = in.take<uint16_t>(), live = in.take<uint16_t>();
            return as(wire::CreateSetParticlesDirect(b, first, &positions, &each, &each,
                                                     which % 2 ? &positions : nullptr, live, e));
        }
        if (which % 5 == 0) return as(wire::CreateImpulse(b, &one, &two, which < 128 ? &three : nullptr, a));
        if (which % 5 == 3) return as(wire::CreateMoveVolume(b, &one));
        std::vector<flatbuffers::Offset<wire::Change>> changes;
        if (which % 5 == 1)
            changes = {wire::CreateChangeDirect(b, "light.to_light", {}, &one),
                       wire::CreateChangeDirect(b, "light.irradiance", {}, &two),
                       wire::CreateChangeDirect(b, "light.rotate", a)};
        else if (which % 5 == 2)
            changes = {wire::CreateChangeDirect(b, "medium.extinction", a),
                       wire::CreateChangeDirect(b, "medium.falloff", c),
                       wire::CreateChangeDirect(b, "medium.anisotropy", d),
                       wire::CreateChangeDirect(b, "medium.albedo", {}, &one)};
        else
            changes = {wire::CreateChangeDirect(b, "render.method", {}, nullptr, name(in, facts.methods[0]).c_str()),
                       wire::CreateChangeDirect(b, "render.isv.quadrature", {}, nullptr, name(in, "simpson").c_str()),
                       wire::CreateChangeDirect(b, "render.isv.steps", in.take<uint16_t>())};
        return as(wire::CreateSetDirect(b, &changes));
    });
}

wire::Packed pose(Numbers& in) {
    const uint32_t seq = in.take<uint8_t>();
    const wire::Vec3 position = vector(in);
    // Any number of sixteenths is rarely a unit quaternion.
    const auto turned = in.take<uint8_t>();
    const float x = turned < 200 ? std::sin(float(turned)) : number(in),
                w = turned < 200 ? std::cos(float(turned)) : number(in);
    const wire::Quat orientation(x, 0, 0, w);
    const float fov_y = number(in), eyes = number(in);
    const auto width = in.take<uint16_t>(), height = in.take<uint16_t>();
    const auto frusta = in.take<uint8_t>();
    const auto frustum = [&] {
        const float left = number(in), right = number(in), up = number(in), down = number(in);
        return wire::Frustum(left, right, up, down);
    };
    const wire::Frustum one = frusta & 1 ? frustum() : wire::Frustum(), two = frusta & 2 ? frustum() : wire::Frustum();
    return wire::pack([&](Builder& b) {
        return wire::CreatePose(b, seq, 7, &position, &orientation, fov_y, eyes, width, height,
                                frusta & 1 ? &one : nullptr, frusta & 2 ? &two : nullptr);
    });
}

wire::Packed hello(Numbers& in) {
    const auto width = in.take<uint16_t>(), height = in.take<uint16_t>();
    const auto views = in.take<uint8_t>(), quality = in.take<uint8_t>();
    const std::string client = name(in, "client"), key = name(in, "");
    return wire::pack([&](Builder& b) {
        const auto client_at = b.CreateString(client), key_at = b.CreateString(key);
        return wire::CreateHello(b, client_at, width, height, views, quality, key_at);
    });
}

wire::Packed made(Kind kind, Numbers& in, const ServerFacts& facts) {
    switch (kind) {
    case kHello:
        return hello(in);
    case kPose:
        return pose(in);
    case kInput:
        return input(in, facts);
    case kAck:
        return wire::pack([&](Builder& b) { return wire::CreateAck(b, in.take<uint32_t>()); });
    case kPong:
        return wire::pack([&](Builder& b) { return wire::CreatePong(b, in.take<uint32_t>(), in.take<uint64_t>()); });
    default:
        return wire::pack([&](Builder& b) { return wire::CreatePing(b, in.take<uint32_t>(), in.take<uint64_t>()); });
    }
}

} // namespace

void session(Bytes bytes) {
    static const NetOptions options;
    static const ServerFacts facts{"device", {"auto"}};
    const auto medium = bytes.size() % 2 == 0 ? net::NamedParticles{} : net::NamedParticles{Layout::live, 300};
    Clock::time_point now{std::chrono::hours(1)};
    net::SessionRules rules(options, facts, now);
    rules.shows(medium);
    Judge judge(options, facts, medium, now);
    net::Actions actions;
    for (Numbers in(bytes); !in.done();) {
        const Kind kind = Kind(in.take<uint8_t>() % kKinds);
        const int64_t wait = in.take<uint8_t>();
        now += microseconds(wait * wait * 100); // up to 6.5 s, mostly less
        actions.clear();
        if (kind == kText) {
            rules.onText(now, actions);
        } else if (kind == kTick) {
            rules.onTick(now, actions);
        } else if (kind == kUnknownFrame) {
            rules.onUnknownFrame(in.take<uint32_t>(), now, actions);
        } else if (kind == kBytes) {
            const Bytes some = in.bytes(in.take<uint16_t>());
            const std::vector<uint8_t> message(some.begin(), some.end()); // exactly so long, and aligned
            rules.onMessage(message, now, actions);
        } else {
            const wire::Packed message = made(kind, in, facts);
            const std::vector<uint8_t> aligned(message.data(), message.data() + message.size());
            rules.onMessage(aligned, now, actions);
        }
        judge.judge(actions, now);
        const auto pause = rules.pause(now);
        promise(pause >= pause.zero() && pause <= std::chrono::seconds(1), "who sends too much is read again soon");
    }
}

} // namespace brume::fuzz
