#include <algorithm>
#include <cctype>

#include "server/options/groups.h"

namespace brume {
namespace {

std::string checkLog(const std::string& name) {
    const bool plain =
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
    return plain && name.size() <= 64 ? "" : "allowed: up to 64 letters, digits, '-' and '_'";
}

std::string checkServers(const std::string& list) {
    for (size_t at = 0, end; at < list.size(); at = end + 1) {
        end = std::min(list.find(',', at), list.size());
        const std::string url = list.substr(at, end - at);
        if (!url.starts_with("nats://") && !url.starts_with("tls://"))
            return "allowed: nats://HOST:PORT or tls://HOST:PORT, several divided by commas";
    }
    return {};
}

std::string checkHosts(const std::string& list) {
    const bool plain = std::all_of(list.begin(), list.end(), [](unsigned char c) {
        return std::isalnum(c) || c == '-' || c == '.' || c == ':' || c == '*' || c == ',';
    });
    return plain ? "" : "allowed: names and addresses without ports, several divided by commas; *.DOMAIN";
}

} // namespace

void addClusterOptions(OptionTable& table, ServerOptions& o) {
    OptionGroup g(table, "Cluster");
    cluster::EngineOptions& engine = o.cluster.engine;
    g.option("--cluster", engine.servers, "NATS servers with JetStream, through which several servers share one scene")
        .check(checkServers)
        .unit("URL,...");
    g.option("--cluster-name", engine.log, "of the log that they share; without it the scene's name")
        .check(checkLog)
        .unit("NAME");
    g.option("--cluster-url", o.cluster.url, "where viewers reach this server: others that are full send them here")
        .check(checkViewerUrl)
        .unit("URL");
    g.option("--cluster-hosts", o.cluster.hosts, "other hosts that viewers may be sent to; *.DOMAIN: all below it")
        .check(checkHosts)
        .unit("HOST,...");
    g.option("--cluster-credentials", engine.credentials, "NATS credentials, .creds").unit("FILE");
    g.option("--cluster-ca", engine.ca, "whom to trust for tls://, PEM, instead of whom the system trusts")
        .unit("FILE");
    g.option("--cluster-certificate", engine.certificate, "what this server shows to NATS, PEM; with --cluster-key")
        .unit("FILE");
    g.option("--cluster-key", engine.key, "its private key, PEM").unit("FILE");
    g.option("--cluster-replicas", engine.replicas, "NATS servers that keep the log").range(1, 5);
    g.mebibytes("--cluster-log-size", engine.log_bytes, "that the log keeps; a tick takes about 100 bytes")
        .range(16u, 1u << 20);
    g.option("--cluster-snapshot", o.cluster.snapshot_s, "between snapshots of the state")
        .range(1, 3600)
        .unit("SECONDS");
    g.milliseconds("--cluster-timeout", engine.timeout, "for NATS to answer at the start");
    g.flag("--cluster-anew", o.cluster.anew, "delete the log and its snapshots first; no other server may run")
        .flagOnly();
}

} // namespace brume
