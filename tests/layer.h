// How much of a test runs. The whole layer runs every case with every method and every seed; it is asked for by
// BRUME_TESTS=whole in the environment. The quick layer, without it, leaves out repetitions, statistics, what waits for
// time to pass, and the largest inputs.
#pragma once

#include <cstdlib>
#include <string_view>

#include <gtest/gtest.h>

namespace brume::test {

// True: the tests, and the programs that they start, were built with a sanitizer and are many times slower.
#if defined(BRUME_SANITIZED)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

inline bool whole() {
    const char* layer = std::getenv("BRUME_TESTS");
    return layer && std::string_view(layer) == "whole";
}

} // namespace brume::test

// First in the body of a test that the quick layer leaves out.
#define BRUME_WHOLE_LAYER_ONLY()                                                                                       \
    if (!::brume::test::whole()) GTEST_SKIP() << "only with BRUME_TESTS=whole"
