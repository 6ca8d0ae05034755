// The kernels for AVX-512: compiled for it (CMakeLists.txt), called only where the CPU has it.
#include <immintrin.h>

namespace brume::bench::native {
namespace {

constexpr unsigned kLanes = 16;
using Floats = float __attribute__((vector_size(kLanes * 4)));
using Ints = int __attribute__((vector_size(kLanes * 4)));

Floats gather(const float* from, Ints index) { return (Floats)_mm512_i32gather_ps((__m512i)index, from, 4); }
Floats permute(Floats v, Ints lane) { return (Floats)_mm512_permutexvar_ps((__m512i)lane, (__m512)v); }

} // namespace
} // namespace brume::bench::native

#include "tools/bench/native/kernel_lanes.h"

namespace brume::bench::native {

const Kernel kAvx512 = {"AVX-512", kLanes, addTile, lightTile, makeRow};

} // namespace brume::bench::native
