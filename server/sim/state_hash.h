// A 64-bit hash (XXH3) of a state made of many numbers. Equal on every machine; reads about 10 GB/s.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#define XXH_INLINE_ALL
#include <xxhash.h>

namespace brume {

class StateHash {
public:
    StateHash() { XXH3_64bits_reset(&state_); }
    // Adds the numbers' bits.
    void add(std::span<const float> values) { XXH3_64bits_update(&state_, values.data(), values.size_bytes()); }
    void add(uint64_t word) { XXH3_64bits_update(&state_, &word, sizeof(word)); }
    void add(std::string_view text) {
        add(uint64_t{text.size()});
        XXH3_64bits_update(&state_, text.data(), text.size());
    }
    uint64_t value() const { return XXH3_64bits_digest(&state_); }

private:
    XXH3_state_t state_;
};

// Of a short text or a value's bytes, in one go.
inline uint64_t hashOf(std::string_view bytes, uint64_t seed) {
    return XXH3_64bits_withSeed(bytes.data(), bytes.size(), seed);
}

} // namespace brume
