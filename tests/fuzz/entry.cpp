// libFuzzer's entry to one target, BRUME_FUZZ_TARGET.
#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
    brume::fuzz::BRUME_FUZZ_TARGET({data, size});
    return 0;
}
