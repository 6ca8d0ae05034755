#include "server/reload.h"

#include <spdlog/spdlog.h>

namespace brume {
namespace {

// The live settings of `from`, among the others of `to`.
void takeLive(ServerOptions& to, const ServerOptions& from) {
    net::NetOptions network = from.net;
    network.listen = to.net.listen;
    network.port = to.net.port;
    network.web_root = to.net.web_root;
    network.threads = to.net.threads;
    to.net = std::move(network);
    to.max_viewers = from.max_viewers;
    to.frame.frame_ms = from.frame.frame_ms;
    to.log_level = from.log_level;
    to.drain = from.drain;
    to.drain_to = from.drain_to;
    to.grace = from.grace;
}

} // namespace

void reload(ParsedOptions& now, int argc, const char* const* argv, const Running& running) {
    const ParsedOptions next = parseServerOptions(argc, argv);
    if (!next.options) {
        spdlog::error("reload: nothing is changed: {}", next.complaint);
        return;
    }
    // Whatever the level is and becomes: what a reload changes is always seen.
    spdlog::set_level(spdlog::level::info);
    size_t changes = 0;
    for (size_t i = 0; i < now.settings.size(); ++i) {
        Setting& old = now.settings[i];
        const Setting& with = next.settings[i];
        if (old.value == with.value) continue;
        const std::string from = old.value.empty() ? "(none)" : old.value, to = with.value.empty() ? "(none)" : with.value;
        if (!old.live) {
            spdlog::warn("reload: {} stays {}: {} needs a restart", old.name, from, to);
            continue;
        }
        spdlog::info("reload: {} {} -> {}", old.name, from, to);
        old = with;
        ++changes;
    }
    if (changes > 0) {
        takeLive(*now.options, *next.options);
        running.audience.setMaxViewers(now.options->max_viewers);
        running.frames.setFrameBudget(now.options->frame.frame_ms);
        running.network.setOptions(now.options->net);
    }
    spdlog::info("reload: {} setting{} changed", changes, changes == 1 ? "" : "s");
    spdlog::set_level(spdlog::level::from_str(now.options->log_level));
}

} // namespace brume
