#include "server/loop/promise_watch.h"

#include <fmt/format.h>

namespace brume {

const ViewError* worstOf(std::span<const ViewError> errors, const std::string& method) {
    const ViewError* worst = nullptr;
    for (const ViewError& one : errors)
        if (one.method == method && one.error.known() && (!worst || one.error.low > worst->error.low)) worst = &one;
    return worst;
}

std::optional<PromiseWatch::Line> PromiseWatch::look(const Seen& seen, Time now) {
    const bool other = promised_ && *promised_ != seen.promised;
    promised_ = seen.promised;
    if (seen.relaxed || other) unjudged_ = now + ErrorWindow::kKept;
    if (seen.promised <= 0 || !seen.worst || (unjudged_ && now < *unjudged_)) {
        above_.reset();
        return {};
    }
    const ErrorEstimate& error = seen.worst->error;
    if (error.low <= seen.promised) {
        above_.reset();
        if (!broken_) return {};
        broken_ = false;
        return Line{false,
                    fmt::format("pictures keep render.error again ({:.2g} %): measured {:.2g} % ({:.2g} to {:.2g})",
                                100 * seen.promised, 100 * error.rmse, 100 * error.low, 100 * error.high)};
    }
    if (!above_) above_ = now;
    if (broken_ || now - *above_ < kBroken || (last_said_ && now - *last_said_ < kApart)) return {};
    last_said_ = now;
    broken_ = true;
    std::string text = fmt::format(
        "pictures err more than render.error promises ({:.2g} %): viewer {} sees {:.2g} % ({:.2g} to {:.2g}) with {}",
        100 * seen.promised, seen.worst->viewer, 100 * error.rmse, 100 * error.low, 100 * error.high,
        seen.worst->method);
    if (error.law > 0) text += fmt::format(", predicted {:.2g} %", 100 * error.law);
    return Line{true, std::move(text)};
}

} // namespace brume
