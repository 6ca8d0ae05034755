// SPIR-V with the values of its specialization constants.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/gpu/program.h"

namespace brume::gpu {

// The ids of the specialization constants that this SPIR-V has.
std::vector<uint32_t> constantIds(std::span<const uint32_t> words);
// What is thrown where none of a program's shaders has this one.
Error unknownConstant(const std::string& program, uint32_t id);

// The words of `shader` with these values in place of its specialization constants; other constants get their defaults.
// Branches and functions that never run with these values are left out. Drivers read a whole shader before they look at
// its constants, so that a smaller one takes less time. Throws Error if the words are no SPIR-V.
std::vector<uint32_t> specialized(const ShaderCode& shader, std::span<const SpecConstant> constants);

} // namespace brume::gpu
