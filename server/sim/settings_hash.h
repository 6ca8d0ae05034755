// A hash of settings by their paths. Only values that differ from their defaults count, in any order: a new setting, a
// table in another order, or one without a row that nobody used has the same hash.
#pragma once

#include <cstdint>
#include <span>

#include "common/settings.h"

namespace brume {

// Of live settings in one element of a list, or in none. 0: all have their defaults. Sums of such hashes of other
// settings or elements are hashes, too. Precondition: their structs are among `parts`.
uint64_t hashOf(std::span<const SceneSetting* const> settings, const SceneParts& parts, uint32_t element = kNoElement);

} // namespace brume
