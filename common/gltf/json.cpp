#include "common/gltf/json.h"

#include <algorithm>
#include <cmath>

namespace brume::gltf {
namespace {

// Memory grows with the number of values and their text, what walks through them with their depth.
void check(std::string_view text) {
    size_t values = 1;
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (quoted && c == '\\')
            ++i;
        else if (c == '"')
            quoted = !quoted;
        if (quoted) continue;
        values += c == ',' || c == '{' || c == '[';
        depth += (c == '{' || c == '[') - (c == '}' || c == ']');
        if (depth > kMostDepth) fail("JSON in JSON deeper than {}", kMostDepth);
    }
    const size_t memory = text.size() + kBytesAValue * values;
    if (memory > kMostJsonMemory)
        fail("its JSON of {} values would take {} MiB of memory; allowed: {} MiB", values, (memory >> 20) + 1,
             kMostJsonMemory >> 20);
}

// Without the text that stands there, which may be long.
std::string reasonOf(std::string what) {
    what = what.substr(0, std::min(what.find("; last read"), what.find("; expected")));
    const size_t name_end = what.starts_with("[") ? what.find("] ") : std::string::npos;
    return name_end == std::string::npos ? what : what.substr(name_end + 2);
}

} // namespace

Json parsed(std::string_view text) {
    check(text);
    try {
        Json out = Json::parse(text);
        if (!out.is_object()) fail("its JSON is no object");
        return out;
    } catch (const Json::exception& error) {
        fail("{}; expected a .glb file, or a .gltf file, which is JSON", reasonOf(error.what()));
    }
}

const Json& member(const Json& of, const char* key) {
    static const Json none;
    if (!of.is_object()) return none;
    const auto found = of.find(key);
    return found == of.end() ? none : *found;
}

const Json& extension(const Json& of, const char* name) { return member(member(of, "extensions"), name); }

size_t wholeOf(const Json& value, const char* what) {
    constexpr double kMost = 9007199254740992.0; // 2^53
    const double number = value.is_number() ? value.get<double>() : -1;
    if (!(number >= 0 && number <= kMost) || number != std::floor(number))
        fail("{} is no whole number from 0 on", what);
    return static_cast<size_t>(number);
}

std::optional<size_t> wholeIn(const Json& of, const char* key) {
    const Json& value = member(of, key);
    if (value.is_null()) return std::nullopt;
    return wholeOf(value, key);
}

double numberIn(const Json& of, const char* key, double otherwise) {
    const Json& value = member(of, key);
    if (value.is_null()) return otherwise;
    if (!value.is_number()) fail("{} is no number", key);
    return value.get<double>();
}

std::string textIn(const Json& of, const char* key) {
    const Json& value = member(of, key);
    if (value.is_null()) return {};
    if (!value.is_string()) fail("{} is no text", key);
    return value.get<std::string>();
}

bool flagIn(const Json& of, const char* key, bool otherwise) {
    const Json& value = member(of, key);
    return value.is_boolean() ? value.get<bool>() : otherwise;
}

const Json& listIn(const Json& of, const char* key) {
    const Json& value = member(of, key);
    if (!value.is_null() && !value.is_array()) fail("{} is no list", key);
    return value;
}

bool numbersIn(const Json& of, const char* key, std::span<double> out) {
    const Json& list = listIn(of, key);
    if (list.is_null()) return false;
    if (list.size() != out.size()) fail("{} has {} numbers; allowed: {}", key, list.size(), out.size());
    for (size_t i = 0; i < out.size(); ++i) {
        if (!list[i].is_number()) fail("{} holds something that is no number", key);
        out[i] = list[i].get<double>();
    }
    return true;
}

} // namespace brume::gltf
