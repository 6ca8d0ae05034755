// The kernels for AVX2: compiled for it (CMakeLists.txt), called only where the CPU has it.
#include <immintrin.h>

namespace brume::bench::native {
namespace {

constexpr unsigned kLanes = 8;
using Floats = float __attribute__((vector_size(kLanes * 4)));
using Ints = int __attribute__((vector_size(kLanes * 4)));

Floats gather(const float* from, Ints index) { return (Floats)_mm256_i32gather_ps(from, (__m256i)index, 4); }
Floats permute(Floats v, Ints lane) { return (Floats)_mm256_permutevar8x32_ps((__m256)v, (__m256i)lane); }

} // namespace
} // namespace brume::bench::native

#include "tools/bench/native/kernel_lanes.h"

namespace brume::bench::native {

const Kernel kAvx2 = {"AVX2", kLanes, addTile, lightTile, makeRow};

} // namespace brume::bench::native
