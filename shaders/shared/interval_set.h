// The union of intervals on a line, as disjoint parts in ascending order. Parts are merged as intervals come, in any
// order, so nothing is sorted (Mattsson 2022 counts sorted entries and exits instead).
#ifndef BRUME_SHARED_INTERVAL_SET_H
#define BRUME_SHARED_INTERVAL_SET_H

#include "real.h"

#ifdef __cplusplus
#include <cstdint>
#define BRUME_INOUT(Type) Type&
namespace brume::physics {
using uint = uint32_t;
#else
#define BRUME_INOUT(Type) inout Type
#endif
const uint kMostParts = 32u;
#ifdef __cplusplus
}
#endif

BRUME_PHYSICS_BEGIN

BRUME_STRUCT IntervalSet {
    uint count; // of the parts
    real fused; // length of gaps that count as covered, since there were more than kMostParts parts
    real begins[kMostParts];
    real ends[kMostParts];
};

// Takes [begin, end] into the set. Precondition: begin <= end.
BRUME_FN void addInterval(BRUME_INOUT(BRUME_OF(IntervalSet)) set, real begin, real end) {
    uint first = 0u; // the first part that does not end before the interval
    while (first < set.count && set.ends[first] < begin) ++first;
    uint behind = first; // the first part that begins behind it
    while (behind < set.count && set.begins[behind] <= end) {
        begin = min(begin, set.begins[behind]);
        end = max(end, set.ends[behind]);
        ++behind;
    }
    if (first == behind && set.count == kMostParts) { // no room: the smaller gap beside it counts as covered
        const bool has_before = first > 0u, has_behind = first < set.count;
        const real before = has_before ? begin - set.ends[first - 1u] : real(0);
        const real after = has_behind ? set.begins[first] - end : real(0);
        if (has_before && (!has_behind || before < after)) {
            set.fused += before;
            set.ends[first - 1u] = end;
        } else {
            set.fused += after;
            set.begins[first] = begin;
        }
        return;
    }
    if (first == behind) {
        for (uint i = set.count; i > first; --i) {
            set.begins[i] = set.begins[i - 1u];
            set.ends[i] = set.ends[i - 1u];
        }
        set.count += 1u;
    } else {
        const uint fewer = behind - first - 1u;
        if (fewer > 0u)
            for (uint i = behind; i < set.count; ++i) {
                set.begins[i - fewer] = set.begins[i];
                set.ends[i - fewer] = set.ends[i];
            }
        set.count -= fewer;
    }
    set.begins[first] = begin;
    set.ends[first] = end;
}

// Length of the union.
BRUME_FN real lengthOf(BRUME_OF(IntervalSet) set) {
    real sum = real(0);
    for (uint i = 0u; i < set.count; ++i) sum += set.ends[i] - set.begins[i];
    return sum;
}

BRUME_PHYSICS_END

#endif
