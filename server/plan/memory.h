// Memory that a scene's particles and its light need, estimated before any of it is allocated.
#pragma once

#include <cstdint>
#include <string>

#include "shaders/shared/types.h"

namespace brume {

class Simulation;
struct Scene;
struct Tetrahedra;
struct Volume;

struct ParticleMemory {
    uint64_t cpu = 0;    // bytes: the simulation's columns, twice for a restart, and the renderer's lists
    uint64_t device = 0; // bytes: lists, uploads in flight, sort, bins, and the buffers of the method that needs most
    uint64_t total() const { return cpu + device; }
};

// Upper bound for `count` particles, with levels of detail, a picture of 1920 x 1080 and three submissions in flight.
// Memory that does not grow with the count (pictures, shadow maps, fields of slabs) is left out.
ParticleMemory particleMemory(uint32_t count);

// Bytes of the CPU's memory and of the device's for a mesh; nothing for null.
ParticleMemory tetrahedraMemory(const Tetrahedra* mesh);

// More bytes for so many ellipsoids than for balls.
ParticleMemory ellipsoidMemory(size_t count);

// Bytes for a volume's voxels; nothing for null.
ParticleMemory volumeMemory(const Volume* volume);

// Empty if `count` particles fit `most` bytes, with `besides` bytes that they take more, and with the
// mesh whose corners they are; otherwise one line. Without a mesh it says how many would fit. Null: there is no mesh.
std::string memoryRefusal(uint32_t count, uint64_t most, uint64_t besides = 0, const Tetrahedra* mesh = nullptr);

// The most particles of the scene that can be alive. Throws SceneError when so many do not fit `most` bytes.
uint32_t boundedCapacity(const Scene& scene, const Simulation& simulation, uint64_t most);

} // namespace brume
