// Counts: numbers that shaders add to, and that the CPU reads after a submission.
#pragma once

#include "server/gpu/commands.h"
#include "server/gpu/resource.h"

namespace brume::gpu {

class Counts {
public:
    Counts(const Device& device, uint32_t count, const char* name);

    // Records what comes before shaders that count: the first time numbers become 0. Nothing of them is on the device.
    void begin(Commands& commands);
    // Records what comes after these shaders: numbers are copied to where the CPU reads them.
    void end(Commands& commands);

    const Buffer& buffer() const { return counts_; } // uint[count], for atomicAdd
    // A number modulo 2^32, since the first begin(), of submissions that are done.
    uint32_t operator[](uint32_t i) const;
    // The same since the last call for it.
    uint32_t since(uint32_t i);

private:
    Buffer counts_, back_;
    std::vector<uint32_t> before_;
    bool begun_ = false; // True: they hold numbers
};

} // namespace brume::gpu
