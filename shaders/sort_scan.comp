#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
// Exclusive prefix sum of the histogram, in one workgroup: each thread sums a run, the sums are scanned, each thread
// writes its run.

layout(local_size_x = 256) in;

layout(scalar) buffer Histogram { uint histogram[]; };

layout(push_constant, scalar) uniform Push { uint count; } push;

shared uint sums[256];

void main() {
    const uint thread = gl_LocalInvocationIndex;
    const uint run = (push.count + 255) / 256;
    const uint first = min(thread * run, push.count), end = min(first + run, push.count);
    uint sum = 0;
    for (uint i = first; i < end; ++i) sum += histogram[i];
    sums[thread] = sum;
    barrier();
    for (uint step = 1; step < 256; step *= 2) {
        const uint before = thread >= step ? sums[thread - step] : 0;
        barrier();
        sums[thread] += before;
        barrier();
    }
    uint offset = sums[thread] - sum;
    for (uint i = first; i < end; ++i) {
        const uint here = histogram[i];
        histogram[i] = offset;
        offset += here;
    }
}
