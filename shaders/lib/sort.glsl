// One pass of a stable least-significant-digit radix sort (after Harada and Howes, 2011), 4 bits a pass. Every thread
// owns a run of consecutive keys and its own counters, so the order is stable and no subgroup size is assumed.

layout(local_size_x = 64) in;

const uint kThreads = 64;
const uint kKeysPerThread = 16;
const uint kBlock = kThreads * kKeysPerThread;
const uint kDigits = 16;

layout(push_constant, scalar) uniform Push {
    uint count;  // keys
    uint shift;  // lowest bit of this pass's digit
    uint blocks; // ceil(count / kBlock)
} push;

shared uint counts[kDigits * kThreads]; // [digit][thread]

uint digitOf(uint key) { return (key >> push.shift) & (kDigits - 1); }

#define countDigits(thread, first)                                                              \
    {                                                                                           \
        for (uint d = 0; d < kDigits; ++d) counts[d * kThreads + (thread)] = 0;                 \
        const uint end = min((first) + kKeysPerThread, push.count);                             \
        for (uint i = (first); i < end; ++i) ++counts[digitOf(keys[i]) * kThreads + (thread)];  \
    }
