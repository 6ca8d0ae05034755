// Helpers of the fuzz targets: promises (conditions that must hold), and the fuzzer's bytes read as numbers or as a
// file.
#pragma once

#include <cstdlib>
#include <cstring>
#include <iostream>
#include <string_view>
#include <type_traits>

#include <glm/glm.hpp>

#include "common/scene_limits.h"
#include "tests/fuzz/targets.h"

namespace brume::fuzz {

// Ends the program and names the promise unless it holds. libFuzzer then keeps the input.
inline void promise(bool holds, const char* what, std::string_view shown = {}) {
    if (holds) return;
    std::cerr << "broken promise: " << what << (shown.empty() ? "" : ": ") << shown << std::endl;
    std::abort();
}

// True: each component is allowed.
inline bool within(glm::vec3 v, Limits allowed) {
    return allowed.holds(v.x) && allowed.holds(v.y) && allowed.holds(v.z);
}

// A message for people must be one line without control characters.
inline void promiseOneLine(std::string_view text, size_t longest) {
    promise(!text.empty(), "a message says something");
    promise(text.size() <= longest, "a message is not endless", text);
    for (const char c : text)
        promise(static_cast<unsigned char>(c) >= ' ' && c != 127, "a message is one printable line", text);
}

inline std::string_view textOf(Bytes bytes) { return {reinterpret_cast<const char*>(bytes.data()), bytes.size()}; }

// Reads the bytes as numbers of any value, one after another; zeros after the end.
class Numbers {
public:
    explicit Numbers(Bytes bytes) : bytes_(bytes) {}
    bool done() const { return bytes_.empty(); }
    template <class T>
    T take() {
        static_assert(std::is_arithmetic_v<T>);
        T value{};
        const Bytes some = bytes(sizeof(T));
        std::memcpy(&value, some.data(), some.size());
        return value;
    }
    // The next `count` bytes, or fewer at the end.
    Bytes bytes(size_t count) {
        const Bytes some = bytes_.first(count < bytes_.size() ? count : bytes_.size());
        bytes_ = bytes_.subspan(some.size());
        return some;
    }

private:
    Bytes bytes_;
};

// Path of a file in memory with these bytes. Valid until the next call.
const char* asFile(Bytes bytes);

} // namespace brume::fuzz
