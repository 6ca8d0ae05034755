#include "server/net/visitor_log.h"

#include <spdlog/spdlog.h>

namespace brume::net {
namespace {

constexpr size_t kMostLately = 1024; // networks that are told apart; further ones share one count
constexpr char kOthers[] = "other addresses";

void sayLeftOut(const std::string& network, uint64_t& count) {
    if (count > 0) spdlog::info("... and {} more lines of {}", count, network);
    count = 0;
}

} // namespace

VisitorLog::~VisitorLog() {
    for (auto& [network, lately] : lately_) sayLeftOut(network, lately.left_out);
}

void VisitorLog::forgetQuiet(TokenBucket::Time::time_point now) {
    forget_at_ = now + std::chrono::seconds(1);
    for (auto& [network, lately] : lately_)
        if (lately.lines.full(now)) sayLeftOut(network, lately.left_out);
    std::erase_if(lately_, [&](const auto& one) { return one.second.lines.full(now); });
}

void VisitorLog::write(spdlog::level::level_enum level, const std::string& network, const std::string& line,
                       TokenBucket::Time::time_point now) {
    if (!spdlog::should_log(level)) return;
    const std::scoped_lock lock(mutex_);
    if (!lately_.contains(network) && lately_.size() >= kMostLately && now >= forget_at_) forgetQuiet(now);
    const std::string& name = lately_.contains(network) || lately_.size() < kMostLately ? network : kOthers;
    Lately& lately = lately_[name];
    if (!lately.lines.take(now) || !all_.take(now)) {
        ++lately.left_out;
        return;
    }
    sayLeftOut(name, lately.left_out);
    spdlog::log(level, line);
}

} // namespace brume::net
