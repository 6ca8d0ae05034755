#include "server/net/commands.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "common/scene_limits.h"
#include "server/net/convert.h"

namespace brume::net {
namespace {

// Reads fields one after another and keeps the first refusal.
class Reader {
public:
    std::optional<Refusal> refusal;

    float number(const char* name, float value, Limits allowed) {
        if (!allowed.holds(value))
            refuse(wire::ErrorCode::out_of_range, fmt::format("{} must be {} ... {}", name, allowed.lo, allowed.hi));
        return value;
    }
    std::optional<float> number(const char* name, flatbuffers::Optional<float> value, Limits allowed) {
        if (!value) return {};
        return number(name, *value, allowed);
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
    std::optional<std::string> name(const char* what, const flatbuffers::String* value, const std::vector<std::string>& known) {
        if (!value) return {};
        std::string asked = value->str();
        if (std::find(known.begin(), known.end(), asked) == known.end())
            refuse(wire::ErrorCode::unknown_name, fmt::format("no such {}; there is {}", what, fmt::join(known, ", ")));
        return asked;
    }

private:
    void refuse(wire::ErrorCode code, std::string text) {
        if (!refusal) refusal = Refusal{code, std::move(text)};
    }
};

CommandBody readBody(const wire::Input& input, const SceneFacts& facts, Reader& in) {
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
    case wire::Command::SetLight: {
        const auto& c = *input.command_as_SetLight();
        SetLight light;
        if (c.to_light()) light.to_light = in.direction("to_light", *c.to_light());
        light.irradiance = in.vector("irradiance", c.irradiance(), limits::kRadiance);
        light.rotate = in.number("rotate", c.rotate(), limits::kRotate);
        return light;
    }
    case wire::Command::SetMedium: {
        const auto& c = *input.command_as_SetMedium();
        return SetMedium{.extinction = in.number("extinction", c.extinction(), limits::kExtinction),
                         .falloff = in.number("falloff", c.falloff(), limits::kFalloff),
                         .anisotropy = in.number("anisotropy", c.anisotropy(), limits::kAnisotropy),
                         .asymmetry = in.number("asymmetry", c.asymmetry(), limits::kAsymmetry),
                         .albedo = in.vector("albedo", c.albedo(), limits::kColour)};
    }
    case wire::Command::SetRender: {
        const auto& c = *input.command_as_SetRender();
        SetRender render;
        render.method = in.name("method", c.method(), facts.methods);
        render.quadrature = in.name("quadrature", c.quadrature(), facts.quadratures);
        if (c.steps()) {
            in.number("steps", float(*c.steps()), limits::kSteps);
            render.steps = *c.steps();
        }
        render.exposure = in.number("exposure", c.exposure(), limits::kExposure);
        return render;
    }
    case wire::Command::SetSimulation: {
        const auto paused = input.command_as_SetSimulation()->paused();
        return SetSimulation{paused ? std::optional<bool>(*paused) : std::nullopt};
    }
    case wire::Command::Restart:
        return Restart{};
    case wire::Command::NONE:
        break; // not from wire::parse
    }
    in.refusal = Refusal{wire::ErrorCode::malformed, "no such command"};
    return Restart{};
}

} // namespace

wire::Role roleFor(wire::Command command) {
    switch (command) {
    case wire::Command::Impulse:
    case wire::Command::MoveVolume:
    case wire::Command::SetLight:
    case wire::Command::SetMedium:
    case wire::Command::SetSimulation:
        return wire::Role::controller;
    case wire::Command::SetRender: // what a frame costs everyone
    case wire::Command::Restart:
    case wire::Command::NONE:
        break;
    }
    return wire::Role::operator_;
}

std::variant<CommandBody, Refusal> readCommand(const wire::Input& input, const SceneFacts& facts) {
    Reader in;
    CommandBody body = readBody(input, facts, in);
    if (in.refusal) return *std::move(in.refusal);
    return body;
}

} // namespace brume::net
