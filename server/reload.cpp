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
    network.tls_certificate = to.net.tls_certificate;
    network.tls_key = to.net.tls_key;
    if (from.token_key != to.token_key) network.token_key = to.net.token_key;
    to.net = std::move(network);
    to.scene = from.scene;
    to.overrides = from.overrides;
    to.max_viewers = from.max_viewers;
    to.max_drawing_viewers = from.max_drawing_viewers;
    to.max_viewers_per_owner = from.max_viewers_per_owner;
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
        const std::string from = old.value.empty() ? "(none)" : old.value,
                          to = with.value.empty() ? "(none)" : with.value;
        const bool of_scene = old.name == "scene" || old.name == "set";
        if (!old.live || (of_scene && !now.options->cluster.engine.servers.empty())) {
            spdlog::warn("reload: {} stays {}: {} needs a restart", old.name, from, to);
            continue;
        }
        spdlog::info("reload: {} {} -> {}", old.name, from, to);
        old = with;
        ++changes;
    }
    ServerOptions& options = *now.options;
    const bool new_key =
        next.options->token_key == options.token_key && next.options->net.token_key != options.net.token_key;
    if (new_key) {
        spdlog::info("reload: the key in {} is another: tokens of the old one are no good any more",
                     options.token_key.string());
        ++changes;
    }
    if (changes > 0 || !options.net.tls_key.empty()) { // a certificate may have been renewed
        takeLive(options, *next.options);
        try {
            running.network.setOptions(options.net);
        } catch (const std::runtime_error& error) {
            spdlog::error("reload: new connections keep what held before: {}", error.what());
        }
        const auto apply = [&](ServedRoom& room) {
            room.audience().setMaxViewers(options.max_viewers, options.max_viewers_per_owner,
                                          options.max_drawing_viewers);
            room.frames().setFrameBudget(options.frame.frame_ms);
        };
        apply(running.home);
        running.rooms.each(apply);
    }
    spdlog::info("reload: {} setting{} changed", changes, changes == 1 ? "" : "s");
    spdlog::set_level(spdlog::level::from_str(options.log_level));
    running.home.scenes()->reload(options);
}

} // namespace brume
