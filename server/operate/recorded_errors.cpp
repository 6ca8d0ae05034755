#include "server/operate/recorded_errors.h"

#include <algorithm>
#include <cmath>

namespace brume {
namespace {

// A recording has no text for what is not finite.
bool known(const ViewError& one) {
    const ErrorEstimate& e = one.error;
    return e.known() && std::isfinite(e.rmse + e.low + e.high + e.bias + e.law);
}

} // namespace

void RecordedErrors::set(std::span<const ViewError> errors) {
    std::erase_if(of_, [&](const auto& kept) {
        return std::ranges::none_of(errors, [&](const ViewError& one) {
            return known(one) && one.viewer == kept.first.first && one.method == kept.first.second;
        });
    });
    for (const ViewError& one : errors) {
        if (!known(one)) continue;
        const auto [kept, is_new] = of_.try_emplace({one.viewer, one.method});
        kept->second.changed = kept->second.changed || kept->second.now != one.error;
        kept->second.now = one.error;
    }
}

std::vector<RecordedError> RecordedErrors::take() {
    std::vector<decltype(of_)::iterator> changed;
    for (auto one = of_.begin(); one != of_.end(); ++one)
        if (one->second.changed) changed.push_back(one);
    std::ranges::stable_sort(changed, {}, [](const auto& one) { return one->second.taken; });
    changed.resize(std::min(changed.size(), kMost));
    ++takes_;
    std::vector<RecordedError> out;
    for (const auto& one : changed) {
        one->second.changed = false;
        one->second.taken = takes_;
        out.push_back({one->first.first, one->first.second, one->second.now});
    }
    return out;
}

} // namespace brume
