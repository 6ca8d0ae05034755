// The operations that `brume-bench operations` times, and the patterns of their indices: one text, compiled as C++ and
// as GLSL.
#ifndef BRUME_BENCH_OPERATIONS_NAMES_H
#define BRUME_BENCH_OPERATIONS_NAMES_H

#ifdef __cplusplus
#include <cstdint>
namespace brume::bench::operations {
using uint = uint32_t;
#endif

const uint kIdOperation = 0u, kIdPattern = 1u;

const uint kConsecutive = 0u, kUniform = 1u, kScattered = 2u;

const uint kNothing = 0u;
const uint kLoadFloat = 1u, kLoadVec2 = 2u, kLoadVec4 = 3u;
const uint kStoreFloat = 4u, kStoreVec4 = 5u, kAtomicAdd = 6u;
const uint kFetchFloat = 7u, kFetchVec4 = 8u, kLinearFloat = 9u, kLinearVec4 = 10u, kGather = 11u, kImageStore = 12u;
const uint kDivide = 13u, kRoot = 14u, kExp2 = 15u, kLog2 = 16u, kSine = 17u, kDivideWhole = 18u;
const uint kBroadcast = 19u, kShuffle = 20u, kSumOfSubgroup = 21u, kBallot = 22u;
const uint kLocalIndex = 23u;                                 // shared memory by gl_LocalInvocationIndex
const uint kSubgroupIndex = 24u;                              // shared memory by the lane's number of its subgroup
const uint kLocalIndexAfter = 25u, kSubgroupIndexAfter = 26u; // the same, with a barrier before
const uint kBarrier = 27u, kSubgroupBarrier = 28u, kMemoryBarrier = 29u;
const uint kTaken = 30u, kSkipped = 31u;   // 16 exp2 in an `if`: of all lanes, of none
const uint kSkippedByLane = 37u;           // as kSkipped, where each lane computes the condition
const uint kFor = 32u, kDo = 33u;          // an inner loop of two rounds, 16 exp2 each: `for`, `do ... while`
const uint kDiverging = 34u;               // the same as kDo with one to four rounds, by lane
const uint kSums = 35u, kSumsChosen = 36u; // 16 sums, all added to; one, by a variable index

#ifdef __cplusplus
} // namespace brume::bench::operations
#endif
#endif
