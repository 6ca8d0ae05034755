#include "server/operate/command_json.h"

#include <bit>
#include <charconv>
#include <cmath>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <utility>

#include <fmt/format.h>
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
void eachField(Restart&, F&&) {}

// In the order of CommandBody.
constexpr const char* kNames[] = {"impulse", "move_volume", "set", "restart", "set_particles", "add", "remove"};
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
void read(const json& from, float& to) {
    to = static_cast<float>(from.get<double>());
    if (!std::isfinite(to)) throw std::runtime_error("a number that float32 does not have");
}
void read(const json& from, uint32_t& to) {
    if (!from.is_number_unsigned() || from.get<uint64_t>() > std::numeric_limits<uint32_t>::max())
        throw std::runtime_error("a whole number of 32 bits");
    to = from.get<uint32_t>();
}
void read(const json& from, glm::vec3& to) {
    if (from.size() != 3) throw std::runtime_error("a vector has three numbers");
    for (int i = 0; i < 3; ++i) read(from.at(static_cast<size_t>(i)), to[i]);
}
float number(const json& from) {
    float value = 0;
    read(from, value);
    return value;
}
uint32_t wholeNumber(const json& from) {
    uint32_t value = 0;
    read(from, value);
    return value;
}

struct Write {
    json& out;
    template <class T>
    void operator()(const char* name, const T& value) {
        out[name] = valueOf(value);
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
};

template <class Body>
json fieldsOf(Body body) {
    json fields = json::object();
    eachField(body, Write{fields});
    return fields;
}
// A list of [path, value], since their order counts.
json pairsOf(const std::vector<Change>& changes) {
    json pairs = json::array();
    for (const Change& change : changes)
        pairs.push_back({change.path(), std::visit([](const auto& value) { return valueOf(value); }, change.value)});
    return pairs;
}
json fieldsOf(const Set& set) { return pairsOf(set.changes); }
json fieldsOf(const Add& add) { return {{"list", nameOf(add.list)}, {"changes", pairsOf(add.changes)}}; }
json fieldsOf(const Remove& remove) { return {{"list", nameOf(remove.list)}, {"element", remove.element}}; }

// The floats of a list, eight hexadecimal digits each: short, and bit for bit.
template <class T>
std::string digitsOf(const std::vector<T>& list) {
    const auto* floats = reinterpret_cast<const float*>(list.data());
    std::string out;
    out.reserve(list.size() * sizeof(T) * 2);
    for (size_t i = 0; i < list.size() * sizeof(T) / sizeof(float); ++i)
        fmt::format_to(std::back_inserter(out), "{:08x}", std::bit_cast<uint32_t>(floats[i]));
    return out;
}
template <class T>
void readDigits(const std::string& digits, std::vector<T>& list) {
    constexpr size_t kEach = 2 * sizeof(T), kFloat = 2 * sizeof(float);
    if (digits.size() % kEach != 0) throw std::runtime_error("a list of floats has eight digits for each");
    list.resize(digits.size() / kEach);
    auto* to = reinterpret_cast<float*>(list.data());
    for (size_t at = 0; at < digits.size(); at += kFloat) {
        uint32_t bits = 0;
        const auto [end, error] = std::from_chars(&digits[at], &digits[at] + kFloat, bits, 16);
        if (error != std::errc{} || end != &digits[at] + kFloat) throw std::runtime_error("a float has eight digits");
        *to++ = std::bit_cast<float>(bits);
    }
}
json fieldsOf(const SetParticles& set) {
    const ParticleRows& rows = *set.rows;
    return {{"first", set.first},
            {"live", set.live},
            {"seconds", set.seconds},
            {"positions", digitsOf(rows.positions)},
            {"scales", digitsOf(rows.scales)},
            {"extinctions", digitsOf(rows.extinctions)},
            {"albedos", digitsOf(rows.albedos)}};
}

SettingValue readValue(const SceneSetting* setting, const std::string& path, const json& in) {
    if (!setting) throw std::runtime_error("no live setting is called " + path);
    SettingValue value = defaultOf(*setting);
    std::visit([&](auto& to) { read(in, to); }, value);
    return value;
}
template <class ChangeOf>
void readPairs(const json& pairs, std::vector<Change>& changes, ChangeOf changeOf) {
    for (const json& pair : pairs) {
        if (!pair.is_array() || pair.size() != 2) throw std::runtime_error("a change is [path, value]");
        changes.push_back(changeOf(pair.at(0).get<std::string>(), pair.at(1)));
    }
}
SceneList listIn(const std::string& name, const json& fields) {
    if (fields.size() != 2) throw std::runtime_error("a field that " + name + " does not have");
    const auto list = sceneList(fields.at("list").get<std::string>());
    if (!list) throw std::runtime_error("no list of that name");
    return *list;
}

template <class Body>
void readFields(const std::string& name, const json& fields, Body& body) {
    Read reader{fields};
    eachField(body, reader);
    if (reader.taken != fields.size()) throw std::runtime_error("a field that " + name + " does not have");
}
void readFields(const std::string&, const json& pairs, Set& set) {
    readPairs(pairs, set.changes, [](const std::string& path, const json& in) {
        return Change(path, readValue(liveSetting(path), path, in));
    });
}
void readFields(const std::string& name, const json& fields, Add& add) {
    add.list = listIn(name, fields);
    readPairs(fields.at("changes"), add.changes, [&](const std::string& path, const json& in) {
        return Change(add.list, path, readValue(elementSetting(add.list, path), path, in));
    });
}
void readFields(const std::string& name, const json& fields, Remove& remove) {
    remove = {listIn(name, fields), wholeNumber(fields.at("element"))};
}

void readFields(const std::string& name, const json& fields, SetParticles& set) {
    if (fields.size() != 7) throw std::runtime_error("a field that " + name + " does not have");
    ParticleRows rows;
    readDigits(fields.at("positions").get<std::string>(), rows.positions);
    readDigits(fields.at("scales").get<std::string>(), rows.scales);
    readDigits(fields.at("extinctions").get<std::string>(), rows.extinctions);
    readDigits(fields.at("albedos").get<std::string>(), rows.albedos);
    set = {wholeNumber(fields.at("first")), wholeNumber(fields.at("live")), number(fields.at("seconds")),
           std::make_shared<const ParticleRows>(std::move(rows))};
    if (const std::string problem = problemOf(set, std::numeric_limits<uint32_t>::max()); !problem.empty())
        throw std::runtime_error(problem);
}

template <size_t I = 0>
CommandBody bodyOf(const std::string& name, const json& fields) {
    if constexpr (I < std::variant_size_v<CommandBody>) {
        if (name != kNames[I]) return bodyOf<I + 1>(name, fields);
        std::variant_alternative_t<I, CommandBody> body;
        readFields(name, fields, body);
        return body;
    } else {
        throw std::runtime_error("no command is called " + name);
    }
}

} // namespace

json toJson(const Command& command) {
    json fields = std::visit([](const auto& body) { return fieldsOf(body); }, command.body);
    return {{"viewer", command.viewer}, {"seq", command.seq}, {kNames[command.body.index()], std::move(fields)}};
}

Command commandOf(const json& in) {
    Command command{wholeNumber(in.at("viewer")), wholeNumber(in.at("seq")), Restart{}};
    if (in.size() != 3) throw std::runtime_error("a command has viewer, seq and one body");
    for (const auto& [name, fields] : in.items())
        if (name != "viewer" && name != "seq") command.body = bodyOf(name, fields);
    return command;
}

} // namespace brume
