// LitTick: the lit medium of one tick, for viewers who draw by themselves. All of them get the same bytes.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "protocol/lit_particles.h"
#include "shaders/shared/types.h"

namespace brume {

struct LitTick {
    uint64_t tick = 0, state_hash = 0;
    uint32_t number = 0, reference = 0; // 0: `changes` are whole
    uint64_t first = 0;                 // id of the first particle
    uint32_t count = 0;
    lit::PackedRows changes, whole; // to the reference; and all by itself, without bytes if nobody needs it
    glm::vec3 origin{0};            // m
    float step = 1;                 // m
    gpu::Tick scene{};              // in the first hue
    struct Hue {
        uint8_t channels;
        float extinction; // part of the particles' extinction
    };
    std::vector<Hue> hues;
    std::vector<gpu::Opaque> objects;
    float exposure = 1;
    bool filmic = true;
    float predicted = 0; // relative RMSE of what viewers draw; 0: not known
};
using LitTickPtr = std::shared_ptr<const LitTick>;

// What a viewer has of earlier messages: the newest of each layer.
class LitHeld {
public:
    // True: it can read changes to the message of this number; 0: whole rows.
    bool has(uint32_t reference) const { return reference == 0 || held_[lit::layerOf(reference)] == reference; }
    // True: it has had no message yet.
    bool isEmpty() const { return held_ == std::array<uint32_t, lit::kLayers>{}; }
    void add(uint32_t number) { held_[lit::layerOf(number)] = number; }

private:
    std::array<uint32_t, lit::kLayers> held_{};
};

} // namespace brume
