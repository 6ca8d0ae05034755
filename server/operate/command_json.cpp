#include "server/operate/command_json.h"

#include <stdexcept>

#include <nlohmann/json.hpp>

namespace brume {
namespace {

using nlohmann::json;

// Every field of a command by its name. The bindings do not compile when a field is added and not named here.
template <class F>
void eachField(Impulse& c, F&& f) {
    auto& [origin, direction, push, strength] = c;
    f("origin", origin), f("direction", direction), f("push", push), f("strength", strength);
}
template <class F>
void eachField(MoveVolume& c, F&& f) {
    auto& [offset] = c;
    f("offset", offset);
}
template <class F>
void eachField(SetLight& c, F&& f) {
    auto& [to_light, irradiance, rotate] = c;
    f("to_light", to_light), f("irradiance", irradiance), f("rotate", rotate);
}
template <class F>
void eachField(SetMedium& c, F&& f) {
    auto& [extinction, falloff, anisotropy, asymmetry, albedo] = c;
    f("extinction", extinction), f("falloff", falloff), f("anisotropy", anisotropy), f("asymmetry", asymmetry),
        f("albedo", albedo);
}
template <class F>
void eachField(SetRender& c, F&& f) {
    auto& [method, quadrature, steps, exposure] = c;
    f("method", method), f("quadrature", quadrature), f("steps", steps), f("exposure", exposure);
}
template <class F>
void eachField(SetSimulation& c, F&& f) {
    auto& [paused] = c;
    f("paused", paused);
}
template <class F>
void eachField(Restart&, F&&) {}

// In the order of CommandBody.
constexpr const char* kNames[] = {"impulse", "move_volume", "set_light", "set_medium", "set_render", "set_simulation", "restart"};
static_assert(std::size(kNames) == std::variant_size_v<CommandBody>);

template <class T>
json valueOf(const T& value) {
    return value;
}
json valueOf(const glm::vec3& v) { return {v.x, v.y, v.z}; }

template <class T>
void read(const json& from, T& to) {
    to = from.get<T>();
}
void read(const json& from, glm::vec3& to) {
    if (from.size() != 3) throw std::runtime_error("a vector has three numbers");
    to = {from.at(0).get<float>(), from.at(1).get<float>(), from.at(2).get<float>()};
}

struct Write {
    json& out;
    template <class T>
    void operator()(const char* name, const T& value) {
        out[name] = valueOf(value);
    }
    template <class T>
    void operator()(const char* name, const std::optional<T>& value) {
        if (value) out[name] = valueOf(*value);
    }
};

struct Read {
    const json& in;
    size_t taken = 0;
    template <class T>
    void operator()(const char* name, T& value) {
        read(in.at(name), value);
        ++taken;
    }
    template <class T>
    void operator()(const char* name, std::optional<T>& value) {
        if (!in.contains(name)) return;
        read(in.at(name), value.emplace());
        ++taken;
    }
};

template <size_t I = 0>
CommandBody bodyOf(const std::string& name, const json& fields) {
    if constexpr (I < std::variant_size_v<CommandBody>) {
        if (name != kNames[I]) return bodyOf<I + 1>(name, fields);
        std::variant_alternative_t<I, CommandBody> body;
        Read reader{fields};
        eachField(body, reader);
        if (reader.taken != fields.size()) throw std::runtime_error("a field that " + name + " does not have");
        return body;
    } else {
        throw std::runtime_error("no command is called " + name);
    }
}

} // namespace

json toJson(const Command& command) {
    json fields = json::object();
    CommandBody body = command.body;
    std::visit([&](auto& b) { eachField(b, Write{fields}); }, body);
    return {{"viewer", command.viewer}, {"seq", command.seq}, {kNames[command.body.index()], std::move(fields)}};
}

Command commandOf(const json& in) {
    Command command{in.at("viewer").get<uint32_t>(), in.at("seq").get<uint32_t>(), Restart{}};
    if (in.size() != 3) throw std::runtime_error("a command has viewer, seq and one body");
    for (const auto& [name, fields] : in.items())
        if (name != "viewer" && name != "seq") command.body = bodyOf(name, fields);
    return command;
}

} // namespace brume
