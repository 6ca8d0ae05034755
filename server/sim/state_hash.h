// A 64-bit hash of many numbers at about 8 bytes a cycle: to compare states, not to withstand an adversary.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "server/sim/random.h"

namespace brume {

class StateHash {
public:
    // Floats go in as their bits. Lanes are independent, so that multiplications overlap.
    void add(std::span<const float> values) {
        size_t i = 0;
        for (; i + 2 * kLanes <= values.size(); i += 2 * kLanes) {
            std::array<uint64_t, kLanes> words;
            std::memcpy(words.data(), values.data() + i, sizeof(words));
            for (size_t l = 0; l < kLanes; ++l) lane_[l] = mixed(lane_[l], words[l]);
        }
        for (; i < values.size(); ++i) lane_[0] = mixed(lane_[0], std::bit_cast<uint32_t>(values[i]));
        addWord(values.size());
    }
    void addWord(uint64_t word) { lane_[1] = mixed(lane_[1], word); }
    uint64_t value() const {
        uint64_t all = 0;
        for (const uint64_t lane : lane_) all = mix64(all ^ lane) + lane;
        return mix64(all);
    }

private:
    static constexpr size_t kLanes = 8;
    // The multiplication carries a bit upward, the rotation brings it down again; both can be undone, so no difference is lost
    // alone.
    static constexpr uint64_t mixed(uint64_t lane, uint64_t word) { return std::rotl((lane ^ word) * 0x9e3779b97f4a7c15u, 29); }

    std::array<uint64_t, kLanes> lane_{1, 2, 3, 4, 5, 6, 7, 8};
};

} // namespace brume
