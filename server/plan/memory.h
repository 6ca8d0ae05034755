// What a scene's particles take of memory: bounded before anything is made of them.
#pragma once

#include <cstdint>
#include <string>

namespace brume {

struct ParticleMemory {
    uint64_t cpu = 0;    // bytes: the simulation's columns, twice for a restart, and the renderer's lists
    uint64_t device = 0; // bytes: lists, uploads on their way, sort, bits of bins, and the dearest method's own
    uint64_t total() const { return cpu + device; }
};

// Of `count` particles, at most: with merged media, a picture of 1920 x 1080 and three submissions in work. What else there is
// (pictures, shadow maps, fields of slabs) does not grow with the count.
ParticleMemory particleMemory(uint32_t count);

// Empty when `count` particles fit `most` bytes; else one line that says how many would.
std::string memoryRefusal(uint32_t count, uint64_t most);

} // namespace brume
