#include "server/net/command_message.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <openssl/evp.h>

#include "common/nearest.h"
#include "common/scene_limits.h"
#include "server/net/convert.h"

namespace brume::net {
namespace {

constexpr size_t kMostText = 8 << 20; // characters: more than any viewer's message has

// Why a setting cannot be changed: in one line, without the sender's text unless it is a setting's name.
std::string whyNotLive(std::string_view path) {
    for (const SceneSetting& setting : sceneSettings())
        if (setting.path == path)
            return setting.in_list ? fmt::format("{} of which? {}[0].{} is the first one's", setting.key(),
                                                 setting.table(), setting.key())
                                   : fmt::format("{} changes only with a restart", path);
    const std::optional<ElementPath> at = elementPath(path);
    std::vector<std::string> names;
    for (const SceneSetting* setting : at ? liveSettings(at->list) : liveSettings())
        names.emplace_back(at ? setting->key() : setting->path);
    const std::string near = didYouMean(at ? at->key : path, names);
    return "no such live setting" + (near.empty() ? "; docs/scenes.md has those that there are" : near);
}

// What a setting of that value's type takes.
const char* kindOf(const SettingValue& value) {
    constexpr const char* kKinds[]{"true or false", "a number", "a whole number", "three numbers", "a text"};
    static_assert(std::size(kKinds) == std::variant_size_v<SettingValue>);
    return kKinds[value.index()];
}

// Reads fields one after another and keeps the first refusal.
class Reader {
public:
    std::optional<Refusal> refusal;

    float number(const char* name, float value, Limits allowed) {
        if (!allowed.holds(value))
            refuse(wire::ErrorCode::out_of_range, fmt::format("{} must be {} ... {}", name, allowed.lo, allowed.hi));
        return value;
    }
    glm::vec3 vector(const char* name, const wire::Vec3& value, Limits allowed) {
        const glm::vec3 v = toGlm(value);
        for (int i = 0; i < 3; ++i) number(name, v[i], allowed);
        return v;
    }
    std::optional<glm::vec3> vector(const char* name, const wire::Vec3* value, Limits allowed) {
        if (!value) return {};
        return vector(name, *value, allowed);
    }
    glm::vec3 direction(const char* name, const wire::Vec3& value) {
        const glm::vec3 v = vector(name, value, limits::kPlace);
        if (!(glm::length(v) > 1e-6f)) refuse(wire::ErrorCode::out_of_range, fmt::format("{} must not be zero", name));
        return v;
    }
    void change(Set& set, const wire::Change& c) {
        const std::string_view path = c.path()->string_view();
        if (const SceneSetting* setting = liveSetting(path)) {
            if (auto value = valueOf(*setting, c)) add(set.changes, {path, *std::move(value)});
        } else {
            refuse(wire::ErrorCode::unknown_name, whyNotLive(path));
        }
    }
    Add element(const wire::Add& c) {
        Add out{list(c.list()->string_view()), {}};
        for (uint32_t i = 0; c.changes() && i < c.changes()->size(); ++i) {
            const wire::Change& change = *c.changes()->Get(i);
            const std::string_view path = change.path()->string_view();
            if (const SceneSetting* setting = elementSetting(out.list, path)) {
                if (auto value = valueOf(*setting, change)) add(out.changes, {out.list, path, *std::move(value)});
            } else {
                refuse(wire::ErrorCode::unknown_name, fmt::format("no setting of a new {}; paths have no index: {}",
                                                                  nameOf(out.list), liveSettings(out.list)[1]->path));
            }
        }
        return out;
    }
    Remove removal(const wire::Remove& c) {
        const std::optional<ElementPath> at = elementPath(c.path()->string_view());
        if (at && at->key.empty()) return {at->list, at->element};
        refuse(wire::ErrorCode::unknown_name, "no such element: fog[0] is the first fog");
        return {};
    }
    SetParticles particles(const wire::SetParticles& c) {
        ParticleRows rows;
        SetParticles set{c.first(), c.live(), c.seconds(), nullptr};
        const bool whole = vectors(c.positions(), rows.positions) && vectors(c.albedos(), rows.albedos);
        if (c.scales()) rows.scales.assign(c.scales()->begin(), c.scales()->end());
        if (c.extinctions()) rows.extinctions.assign(c.extinctions()->begin(), c.extinctions()->end());
        set.rows = std::make_shared<const ParticleRows>(std::move(rows));
        if (!whole)
            refuse(wire::ErrorCode::out_of_range, "positions and albedos have three numbers for each row");
        else if (std::string problem = problemOf(set, std::numeric_limits<uint32_t>::max()); !problem.empty())
            refuse(wire::ErrorCode::out_of_range, std::move(problem));
        return set;
    }

private:
    SceneList list(std::string_view name) {
        const std::optional<SceneList> found = sceneList(name);
        if (!found) refuse(wire::ErrorCode::unknown_name, "no such list; there are light, fog, plane, box and sphere");
        return found.value_or(SceneList::fogs);
    }
    // Nothing, and refused: it is not of the setting's type.
    std::optional<SettingValue> valueOf(const SceneSetting& setting, const wire::Change& c) {
        SettingValue value = defaultOf(setting);
        if (std::visit([&](auto& to) { return read(c, to); }, value)) return value;
        refuse(wire::ErrorCode::out_of_range, fmt::format("{} takes {}", setting.key(), kindOf(value)));
        return {};
    }
    // False where there are not three numbers for each vector.
    static bool vectors(const flatbuffers::Vector<float>* list, std::vector<glm::vec3>& to) {
        for (uint32_t i = 0; list && i + 2 < list->size(); i += 3)
            to.emplace_back(list->Get(i), list->Get(i + 1), list->Get(i + 2));
        return !list || list->size() % 3 == 0;
    }
    // False where the value is not of the setting's type.
    static bool read(const wire::Change& c, bool& to) {
        to = c.number() == 1.0;
        return c.number() == 0.0 || c.number() == 1.0;
    }
    static bool read(const wire::Change& c, float& to) {
        constexpr double kMost = std::numeric_limits<float>::max(); // beyond every limit; more has no float
        to = float(std::clamp(c.number().value_or(0), -kMost, kMost));
        return c.number().has_value();
    }
    static bool read(const wire::Change& c, uint32_t& to) {
        const double number = c.number().value_or(-1);
        const bool whole = number >= 0 && number <= 4294967295.0 && number == std::floor(number);
        to = whole ? uint32_t(number) : 0;
        return whole;
    }
    static bool read(const wire::Change& c, glm::vec3& to) {
        if (c.vector()) to = toGlm(*c.vector());
        return c.vector() != nullptr;
    }
    static bool read(const wire::Change& c, std::string& to) {
        if (c.text()) to = c.text()->str();
        return c.text() != nullptr;
    }
    void add(std::vector<Change>& changes, Change change) {
        const SceneSetting& setting = *change.setting;
        const std::string key(setting.key());
        if (auto* value = std::get_if<float>(&change.value)) number(key.c_str(), *value, setting.allowed);
        if (auto* value = std::get_if<uint32_t>(&change.value)) number(key.c_str(), float(*value), setting.allowed);
        if (auto* value = std::get_if<glm::vec3>(&change.value))
            setting.form == Form::direction ? direction(key.c_str(), toWire(*value))
                                            : vector(key.c_str(), toWire(*value), setting.allowed);
        changes.push_back(std::move(change));
    }
    void refuse(wire::ErrorCode code, std::string text) {
        if (!refusal) refusal = Refusal{code, std::move(text)};
    }
};

CommandBody bodyOf(const wire::Input& input, Reader& in) {
    switch (input.command_type()) {
    case wire::Command::Impulse: {
        const auto& c = *input.command_as_Impulse();
        return Impulse{.origin = in.vector("origin", *c.origin(), limits::kPlace),
                       .direction = in.direction("direction", *c.direction()),
                       .push = in.vector("push", c.push(), limits::kSpeed).value_or(glm::vec3(0)),
                       .strength = in.number("strength", c.strength(), limits::kStrength)};
    }
    case wire::Command::MoveVolume:
        return MoveVolume{in.vector("offset", *input.command_as_MoveVolume()->offset(), limits::kPlace)};
    case wire::Command::Set: {
        Set set;
        for (const wire::Change* change : *input.command_as_Set()->changes()) in.change(set, *change);
        return set;
    }
    case wire::Command::Restart:
        return Restart{};
    case wire::Command::SetParticles:
        return in.particles(*input.command_as_SetParticles());
    case wire::Command::Add:
        return in.element(*input.command_as_Add());
    case wire::Command::Remove:
        return in.removal(*input.command_as_Remove());
    case wire::Command::Undo:
        return Undo{input.command_as_Undo()->operators()};
    case wire::Command::NONE:
        break; // not from wire::parse
    }
    in.refusal = Refusal{wire::ErrorCode::malformed, "no such command"};
    return Restart{};
}

using Builder = flatbuffers::FlatBufferBuilder;

struct ChangeWriter {
    Builder& b;
    const std::string path;

    auto operator()(const glm::vec3& value) const {
        const wire::Vec3 vector = toWire(value);
        return wire::CreateChangeDirect(b, path.c_str(), {}, &vector);
    }
    auto operator()(const std::string& value) const { // which may have zeros
        const auto name = b.CreateString(path), text = b.CreateString(value);
        return wire::CreateChange(b, name, {}, nullptr, text);
    }
    template <class Number>
    auto operator()(Number value) const {
        return wire::CreateChangeDirect(b, path.c_str(), double(value));
    }
};
auto written(Builder& b, const std::vector<Change>& changes) {
    std::vector<flatbuffers::Offset<wire::Change>> all;
    for (const Change& change : changes) all.push_back(std::visit(ChangeWriter{b, change.path()}, change.value));
    return b.CreateVector(all);
}
template <class T>
auto floats(Builder& b, const std::vector<T>& list) {
    return b.CreateVector(reinterpret_cast<const float*>(list.data()), list.size() * sizeof(T) / sizeof(float));
}

// One for each kind of command: recordings do not compile without.
auto written(Builder& b, const Impulse& c) {
    const wire::Vec3 origin = toWire(c.origin), direction = toWire(c.direction), push = toWire(c.push);
    return wire::CreateImpulse(b, &origin, &direction, &push, c.strength);
}
auto written(Builder& b, const MoveVolume& c) {
    const wire::Vec3 offset = toWire(c.offset);
    return wire::CreateMoveVolume(b, &offset);
}
auto written(Builder& b, const Set& c) { return wire::CreateSet(b, written(b, c.changes)); }
auto written(Builder& b, const Restart&) { return wire::CreateRestart(b); }
auto written(Builder& b, const SetParticles& c) {
    const ParticleRows& rows = *c.rows;
    const auto positions = floats(b, rows.positions), scales = floats(b, rows.scales),
               extinctions = floats(b, rows.extinctions), albedos = floats(b, rows.albedos);
    return wire::CreateSetParticles(b, c.first, positions, scales, extinctions, albedos, c.live, c.seconds);
}
auto written(Builder& b, const Add& c) {
    const auto changes = written(b, c.changes);
    const auto list = b.CreateString(nameOf(c.list));
    return wire::CreateAdd(b, list, changes);
}
auto written(Builder& b, const Remove& c) {
    return wire::CreateRemoveDirect(b, fmt::format("{}[{}]", nameOf(c.list), c.element).c_str());
}
auto written(Builder& b, const Undo& c) { return wire::CreateUndo(b, c.operators); }

template <class Table>
auto input(Builder& b, uint32_t seq, flatbuffers::Offset<Table> command) {
    return wire::CreateInput(b, seq, 0, wire::CommandTraits<Table>::enum_value, command.Union());
}

} // namespace

ReadCommand readCommand(const wire::Input& input) {
    Reader in;
    CommandBody body = bodyOf(input, in);
    return {std::move(body), std::move(in.refusal)};
}

std::string textOf(const Command& command) {
    const wire::Packed message = wire::pack([&](Builder& b) {
        b.ForceDefaults(true); // -0 would be left out where 0 is the default
        return std::visit([&](const auto& body) { return input(b, command.seq, written(b, body)); }, command.body);
    });
    std::string text(4 * ((message.size() + 2) / 3) + 1, '\0'); // and a zero
    text.resize(
        size_t(EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()), message.data(), int(message.size()))));
    return text;
}

Command commandOf(const std::string& text) {
    std::vector<uint8_t> bytes(text.size());
    const int size =
        text.size() > kMostText
            ? -1
            : EVP_DecodeBlock(bytes.data(), reinterpret_cast<const unsigned char*>(text.data()), int(text.size()));
    const int padding = int(text.ends_with('=')) + int(text.ends_with("=="));
    if (size < padding) throw std::runtime_error("a command that is not base64");
    bytes.resize(size_t(size - padding));
    const auto parsed = wire::parse(bytes);
    const auto* input = parsed ? parsed->as<wire::Input>() : nullptr;
    if (!input) throw std::runtime_error("a command that is not an Input of brume.v1");
    ReadCommand read = readCommand(*input);
    if (read.refusal) throw std::runtime_error("a command that is refused: " + read.refusal->text);
    return {0, input->seq(), std::move(read.body)};
}

} // namespace brume::net
