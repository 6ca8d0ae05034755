// allocations(): the number of allocations so far. Its source replaces operator new by one that counts.
#pragma once

#include <cstddef>

namespace brume {
size_t allocations();
}
