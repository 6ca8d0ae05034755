// Child processes of the integration tests, and the time to wait for them.
#pragma once

#include "common/process.h"

namespace brume::test {

using std::chrono::milliseconds;

constexpr milliseconds kPatience = Process::kPatience;

} // namespace brume::test
