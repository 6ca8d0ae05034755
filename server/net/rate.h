// Limits how often something may happen.
#pragma once

#include <algorithm>
#include <chrono>
#include <optional>

namespace brume::net {

// A bucket of `burst` tokens that refills with `rate` tokens a second. An action takes one token.
class TokenBucket {
public:
    using Time = std::chrono::steady_clock;

    TokenBucket(double rate, double burst) : rate_(rate), burst_(burst), tokens_(burst) {}
    bool take(Time::time_point now) {
        refill(now);
        if (tokens_ < 1) return false;
        tokens_ -= 1;
        return true;
    }
    // Takes `tokens` for what has happened already, also where they are not there: then take() waits longer. False, and
    // only what is there to owe, if that is more than a burst below none.
    bool charge(double tokens, Time::time_point now) {
        refill(now);
        tokens_ = std::max(tokens_ - tokens, -burst_);
        return tokens_ > -burst_;
    }
    // The time until take() succeeds.
    Time::duration wait(Time::time_point now) {
        refill(now);
        if (tokens_ >= 1) return {};
        return std::chrono::duration_cast<Time::duration>(std::chrono::duration<double>((1 - tokens_) / rate_));
    }
    // True if the bucket is full: it behaves like a new one.
    bool full(Time::time_point now) const {
        const std::chrono::duration<double> passed = now - last_.value_or(now);
        return tokens_ + rate_ * passed.count() >= burst_;
    }

private:
    void refill(Time::time_point now) {
        const std::chrono::duration<double> passed = now - last_.value_or(now);
        if (passed.count() > 0) tokens_ = std::min(burst_, tokens_ + rate_ * passed.count());
        last_ = std::max(now, last_.value_or(now));
    }
    double rate_, burst_, tokens_;
    std::optional<Time::time_point> last_;
};

} // namespace brume::net
