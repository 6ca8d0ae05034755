// SPIR-V with the values of its specialization constants.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/gpu/program.h"

namespace brume::gpu {

// The words of `shader` with these values in place of its specialization constants, others by their defaults. Branches
// that are never taken with them are left out, and functions that are never called. A driver that reads all of a shader
// before it looks at the constants is done in a fraction of the time. Throws Error if the words are no SPIR-V.
std::vector<uint32_t> specialized(const ShaderCode& shader, std::span<const SpecConstant> constants);

} // namespace brume::gpu
