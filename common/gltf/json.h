// The JSON of a glTF file: read within bounds, and asked member by member. What is wrong throws Wrong.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include "common/gltf/wrong.h"

namespace brume::gltf {

using Json = nlohmann::json;

inline constexpr size_t kMostJsonMemory = 256 << 20; // bytes that JSON may take when it is read
inline constexpr size_t kBytesAValue = 96;           // the most memory of one value, besides its text
inline constexpr int kMostDepth = 64;                // levels of JSON in JSON

// Refuses JSON that is too deep, or would take too much memory, before it takes any.
Json parsed(std::string_view text);

// The member of an object; null where there is none, or where `of` is no object.
const Json& member(const Json& of, const char* key);
const Json& extension(const Json& of, const char* name);

// A whole number from 0 to 2^53; nothing if it is not there.
std::optional<size_t> wholeIn(const Json& of, const char* key);
size_t wholeOf(const Json& value, const char* what);
double numberIn(const Json& of, const char* key, double otherwise);
std::string textIn(const Json& of, const char* key);
bool flagIn(const Json& of, const char* key, bool otherwise);
// An array, or null where there is none.
const Json& listIn(const Json& of, const char* key);
// Exactly out.size() numbers; false, and `out` is left as it is, if there are none.
bool numbersIn(const Json& of, const char* key, std::span<double> out);

} // namespace brume::gltf
