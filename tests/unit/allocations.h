// How often the program has allocated: operator new is replaced by one that counts.
#pragma once

#include <cstddef>

namespace brume {
size_t allocations();
}
