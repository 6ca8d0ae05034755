// What each operation of a shader costs on a device: the table by which the forms of shaders are chosen.
#pragma once

#include <string>

#include "server/gpu/device.h"

namespace brume::bench {

// A Markdown table: nanoseconds of the device for an operation of a lane, the least of `repeats` submissions. A row
// has a column for each pattern of indices.
std::string operationsTable(const gpu::Device& device, uint32_t repeats);

} // namespace brume::bench
