// How much of a test runs. The whole layer runs every case with every method and every seed; it is asked for by
// BRUME_TESTS=whole in the environment. The quick layer, without it, leaves out repetitions.
#pragma once

#include <cstdlib>
#include <string_view>

namespace brume::test {

inline bool whole() {
    const char* layer = std::getenv("BRUME_TESTS");
    return layer && std::string_view(layer) == "whole";
}

} // namespace brume::test
