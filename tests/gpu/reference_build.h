// Generated beside it: reference_build.cpp.
#pragma once

#include <cstdint>

namespace brume::test {

extern const uint64_t kReferenceBuild; // hash of the library brume_reference as it was built

} // namespace brume::test
