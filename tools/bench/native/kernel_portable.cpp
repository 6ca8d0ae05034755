// The kernels for any CPU, with as many lanes as AVX-512 has: so that tests see all that does not depend on its
// instructions.

namespace brume::bench::native {
namespace {

constexpr unsigned kLanes = 16;
using Floats = float __attribute__((vector_size(kLanes * 4)));
using Ints = int __attribute__((vector_size(kLanes * 4)));

Floats gather(const float* from, Ints index) {
    Floats v;
    for (unsigned i = 0; i < kLanes; ++i) v[i] = from[index[i]];
    return v;
}
Floats permute(Floats v, Ints lane) {
    Floats out;
    for (unsigned i = 0; i < kLanes; ++i) out[i] = v[lane[i]];
    return out;
}

} // namespace
} // namespace brume::bench::native

#include "tools/bench/native/kernel_lanes.h"

namespace brume::bench::native {

const Kernel kPortable = {"portable", kLanes, addTile, lightTile, makeRow};

} // namespace brume::bench::native
