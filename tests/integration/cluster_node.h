// Servers of one cluster, and what is to be seen of them.
#pragma once

#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "tests/integration/http.h"
#include "tests/integration/nats_server.h"
#include "tests/integration/running_server.h"
#include "tests/integration/watcher.h"
#include "tests/net/set_message.h"

namespace brume::test {

inline std::vector<std::string> inCluster(const NatsServer& nats, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"--cluster", nats.url(), "--log-level", "info"});
    return more;
}

inline double count(RunningServer& server, const std::string& what) {
    return metric(server.port(), "brume_cluster_" + what).value_or(-1);
}
// Polls until a metric of a cluster is at least so much; false if that does not come. So seldom that the server does
// not refuse to answer.
inline bool waitFor(RunningServer& server, const std::string& what, double least) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (count(server, what) < least) {
        if (std::chrono::steady_clock::now() >= deadline) return false;
        std::this_thread::sleep_for(milliseconds(50));
    }
    return true;
}

inline void setExposure(Watcher& watcher, float exposure) {
    watcher.session.sendCommand<wire::Set>(test::set("render.exposure", exposure));
}

// Ticks from `from` on that both know.
inline size_t commonHashes(const Watcher& a, const Watcher& b, uint64_t from = 0) {
    size_t common = 0;
    for (const auto& [tick, hash] : a.hashes) common += tick >= from && b.hashes.contains(tick);
    return common;
}
// The first tick whose states differ. Nothing: none does.
inline std::optional<uint64_t> firstDifference(const Watcher& a, const Watcher& b) {
    for (const auto& [tick, hash] : a.hashes)
        if (const auto other = b.hashes.find(tick); other != b.hashes.end() && other->second != hash) return tick;
    return {};
}

} // namespace brume::test
