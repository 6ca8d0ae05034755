#include "server/net/agent.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace brume::net {

std::string agentLine(const Load& load) {
    if (load.draining) return "drain\n";
    if (!load.ready) return "down\n";
    if (load.stands) return "up ready 1%\n";
    const float budget = load.budget_used > 0 ? 1 - std::min(load.budget_used, 1.0f) : 1; // also of NaN
    const float places = load.viewers < load.places ? 1 - float(load.viewers) / float(load.places) : 0;
    return fmt::format("up ready {}%\n", std::max(std::lround(100 * std::min(budget, places)), 1L));
}

} // namespace brume::net
