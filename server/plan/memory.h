// Memory that a scene's particles need, estimated before any of it is allocated.
#pragma once

#include <cstdint>
#include <string>

namespace brume {

struct ParticleMemory {
    uint64_t cpu = 0;    // bytes: the simulation's columns, twice for a restart, and the renderer's lists
    uint64_t device = 0; // bytes: lists, uploads in flight, sort, bins, and the buffers of the method that needs most
    uint64_t total() const { return cpu + device; }
};

// Upper bound for `count` particles, with levels of detail, a picture of 1920 x 1080 and three submissions in flight.
// Memory that does not grow with the count (pictures, shadow maps, fields of slabs) is left out.
ParticleMemory particleMemory(uint32_t count);

// Empty if `count` particles fit `most` bytes, with `besides` bytes that do not depend on them; otherwise one line that
// says how many would fit.
std::string memoryRefusal(uint32_t count, uint64_t most, uint64_t besides = 0);

} // namespace brume
