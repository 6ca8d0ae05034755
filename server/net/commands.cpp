#include "server/net/commands.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/nearest.h"
#include "common/scene_limits.h"
#include "server/net/access.h"
#include "server/net/convert.h"

namespace brume::net {
namespace {

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

// Reads fields one after another and keeps the first refusal.
class Reader {
public:
    Reader(const ServerFacts& facts, const ShownMedium& medium) : facts_(facts), medium_(medium) {}

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
        const float length = glm::length(v);
        if (!(length > 1e-6f)) refuse(wire::ErrorCode::out_of_range, fmt::format("{} must not be zero", name));
        return v / length;
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
        if (medium_.layout != Layout::live)
            refuse(wire::ErrorCode::unexpected,
                   "this scene sets its own particles: SetParticles is for layout \"live\"");
        else if (!whole)
            refuse(wire::ErrorCode::out_of_range, "positions and albedos have three numbers for each row");
        else if (std::string problem = problemOf(set, medium_.rows); !problem.empty())
            refuse(wire::ErrorCode::out_of_range, std::move(problem));
        return set;
    }
    // Particles that come from elsewhere do not yield.
    void push() {
        if (medium_.layout == Layout::live || medium_.layout == Layout::sequence)
            refuse(wire::ErrorCode::unexpected, "pushes move nothing here: the particles come from elsewhere");
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
        refuse(wire::ErrorCode::out_of_range, fmt::format("{} has a value of another type", setting.key()));
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
            *value = setting.form == Form::direction ? direction(key.c_str(), toWire(*value))
                                                     : vector(key.c_str(), toWire(*value), setting.allowed);
        if (auto* value = std::get_if<std::string>(&change.value)) known(setting, *value);
        changes.push_back(std::move(change));
    }
    void known(const SceneSetting& setting, const std::string& name) {
        const std::vector<std::string> names = facts_.choicesOf(setting);
        if (std::find(names.begin(), names.end(), name) == names.end())
            refuse(wire::ErrorCode::unknown_name,
                   fmt::format("no such {}; there is {}", setting.key(), fmt::join(names, ", ")));
    }
    void refuse(wire::ErrorCode code, std::string text) {
        if (!refusal) refusal = Refusal{code, std::move(text)};
    }

    const ServerFacts& facts_;
    const ShownMedium& medium_;
};

CommandBody readBody(const wire::Input& input, Reader& in) {
    switch (input.command_type()) {
    case wire::Command::Impulse: {
        const auto& c = *input.command_as_Impulse();
        in.push();
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
    case wire::Command::NONE:
        break; // not from wire::parse
    }
    in.refusal = Refusal{wire::ErrorCode::malformed, "no such command"};
    return Restart{};
}

} // namespace

wire::Role roleFor(const CommandBody& body) {
    const auto* set = std::get_if<Set>(&body);
    const bool costs_everyone = set && std::ranges::any_of(set->changes, [](const Change& one) {
                                    return one.setting->changed_by == ChangedBy::operators;
                                });
    const bool for_operators =
        costs_everyone || std::holds_alternative<Restart>(body) || std::holds_alternative<SetParticles>(body);
    return for_operators ? wire::Role::operator_ : wire::Role::controller;
}

std::variant<CommandBody, Refusal> readCommand(const wire::Input& input, const ServerFacts& facts,
                                               const ShownMedium& medium, wire::Role role) {
    Reader in(facts, medium);
    CommandBody body = readBody(input, in);
    if (const wire::Role least = roleFor(body); role < least)
        return Refusal{wire::ErrorCode::forbidden, forbidden(role, least)};
    if (in.refusal) return *std::move(in.refusal);
    return body;
}

std::optional<bool> pauseOf(const CommandBody& body) {
    const auto* set = std::get_if<Set>(&body);
    if (!set || set->changes.size() != 1 || set->changes[0].setting != liveSetting("simulation.paused")) return {};
    return std::get<bool>(set->changes[0].value);
}

} // namespace brume::net
