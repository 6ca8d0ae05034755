// Log lines that anybody who connects can cause: few enough that a flood does not fill the disk.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include <spdlog/common.h>

#include "server/net/rate.h"

namespace brume::net {

// Thread-safe.
class VisitorLog {
public:
    VisitorLog() = default;
    ~VisitorLog(); // says what was left out
    VisitorLog(const VisitorLog&) = delete;
    VisitorLog& operator=(const VisitorLog&) = delete;

    // Logs the line, or leaves it out if this network (ConnectionSlot::network()) or all together cause too many:
    // kBurst at once, then kRate a second. Before the next line "... and N more" says how many were left out.
    void write(spdlog::level::level_enum level, const std::string& network, const std::string& line,
               TokenBucket::Time::time_point now = TokenBucket::Time::now());

    static constexpr double kBurst = 100, kRate = 1; // of one network
    static constexpr double kBurstOfAll = 2000, kRateOfAll = 20;

private:
    struct Lately {
        TokenBucket lines{kRate, kBurst};
        uint64_t left_out = 0;
    };
    void forgetQuiet(TokenBucket::Time::time_point now); // with mutex_

    std::mutex mutex_;
    TokenBucket all_{kRateOfAll, kBurstOfAll};
    std::map<std::string, Lately> lately_; // kMostLately at most
    TokenBucket::Time::time_point forget_at_{};
};

} // namespace brume::net
