#include "client/load/histogram.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

namespace brume::load {
namespace {

struct Bucket {
    double bound; // `le`: the largest value that it counts
    double count; // samples up to the bound
};

// What was counted between the two, by rising bounds.
std::vector<Bucket> grown(const Series& before, const Series& after, std::string_view histogram) {
    const std::string head = std::string(histogram) + "_bucket{le=\"";
    std::vector<Bucket> buckets;
    for (auto at = after.lower_bound(head); at != after.end() && at->first.starts_with(head); ++at) {
        const auto was = before.find(at->first);
        const double bound = std::strtod(at->first.c_str() + head.size(), nullptr); // also "+Inf"
        buckets.push_back({bound, at->second - (was == before.end() ? 0 : was->second)});
    }
    std::sort(buckets.begin(), buckets.end(), [](const Bucket& a, const Bucket& b) { return a.bound < b.bound; });
    return buckets;
}

} // namespace

double percentileBetween(const Series& before, const Series& after, std::string_view histogram, double fraction) {
    const std::vector<Bucket> buckets = grown(before, after, histogram);
    Bucket below{0, 0};
    if (buckets.empty() || !(buckets.back().count > 0)) return NAN;
    const double wanted = fraction * buckets.back().count;
    for (const Bucket& bucket : buckets) {
        if (bucket.count < below.count) return NAN;
        if (bucket.count >= wanted && bucket.count > below.count) {
            if (std::isinf(bucket.bound)) return below.bound;
            const double part = (wanted - below.count) / (bucket.count - below.count);
            return below.bound + part * (bucket.bound - below.bound);
        }
        below = bucket;
    }
    return NAN;
}

} // namespace brume::load
