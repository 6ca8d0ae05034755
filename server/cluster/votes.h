// Votes: which state the servers of a cluster have at a tick, and whether this one is among those that are right.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace brume::cluster {

class Votes {
public:
    // A server says which hash its state had. Only the last ticks and a bounded number of servers are kept.
    void note(uint64_t tick, const std::string& node, uint64_t hash) {
        auto& of_tick = ticks_[tick];
        if (of_tick.size() < kMostNodes) of_tick[node] = hash;
        while (ticks_.size() > kMostTicks) ticks_.erase(ticks_.begin());
    }
    // The hash that most servers had at the tick. Of hashes with as many votes it is the ticker's, if it has one of
    // them, and else the smallest. Nothing: nobody said any.
    std::optional<uint64_t> winner(uint64_t tick, const std::string& ticker) const {
        const auto found = ticks_.find(tick);
        if (found == ticks_.end()) return {};
        std::map<uint64_t, size_t> counts;
        for (const auto& [node, hash] : found->second) ++counts[hash];
        const auto tickers = found->second.find(ticker);
        std::optional<uint64_t> best;
        size_t most = 0;
        for (const auto& [hash, count] : counts) {
            const bool is_tickers = tickers != found->second.end() && tickers->second == hash;
            if (count > most || (count == most && is_tickers)) best = hash, most = count;
        }
        return best;
    }
    void clear() { ticks_.clear(); }

private:
    static constexpr size_t kMostTicks = 8, kMostNodes = 256;
    std::map<uint64_t, std::map<std::string, uint64_t>> ticks_;
};

} // namespace brume::cluster
