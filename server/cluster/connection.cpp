#include "server/cluster/connection.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include "server/cluster/trust.h"

namespace brume::cluster {
namespace {

constexpr int64_t kPingMs = 1000;  // and after kPings without an answer the connection counts as lost
constexpr int kPings = 2;          // the library's own defaults take four minutes
constexpr int64_t kWriteMs = 2000; // a write that takes longer fails
constexpr int kUnsent = 1 << 20;   // bytes that wait for a connection to come back

// Throws ClusterError where an option is no good.
void set(natsStatus status, const char* option, const std::string& value) {
    if (status != NATS_OK) throw ClusterError(fmt::format("{} {}: {}", option, value, textOf(status)));
}

Link& linkOf(void* closure) { return *static_cast<Link*>(closure); }

void told(natsConnection*, natsSubscription*, natsStatus status, void*) {
    spdlog::warn("NATS: {}", natsStatus_GetText(status));
}

} // namespace

std::string textOf(natsStatus status) {
    const char* last = nats_GetLastError(nullptr);
    return fmt::format("{}{}{}", natsStatus_GetText(status), last && *last ? ": " : "", last ? last : "");
}

void away(const char* what, natsStatus status) { throw EngineAway(fmt::format("{}: {}", what, textOf(status))); }

std::string withoutSecrets(const std::string& servers) {
    std::string out;
    for (const std::string& url : listOf(servers)) {
        const size_t scheme = url.find("://"), from = scheme == url.npos ? 0 : scheme + 3, at = url.rfind('@');
        out += (out.empty() ? "" : ",") + url.substr(0, from) + url.substr(at == url.npos ? from : at + 1);
    }
    return out;
}

Options optionsOf(const EngineOptions& from) {
    for (const auto& [option, file] :
         {std::pair("--cluster-credentials", &from.credentials), std::pair("--cluster-ca", &from.ca),
          std::pair("--cluster-certificate", &from.certificate), std::pair("--cluster-key", &from.key)})
        if (!file->empty() && ::access(file->c_str(), R_OK) != 0)
            throw ClusterError(fmt::format("{} {}: cannot be read: {}", option, file->string(), std::strerror(errno)));
    natsOptions* made = nullptr;
    set(natsOptions_Create(&made), "--cluster", "");
    Options options(made);
    const std::vector<std::string> servers = listOf(from.servers);
    std::vector<const char*> urls;
    for (const std::string& url : servers) urls.push_back(url.c_str());
    set(natsOptions_SetServers(made, urls.data(), int(urls.size())), "--cluster", withoutSecrets(from.servers));
    natsOptions_SetName(made, "brume-server " BRUME_VERSION);
    natsOptions_SetTimeout(made, std::min(kAnswerMs, from.timeout.count()));
    natsOptions_SetMaxReconnect(made, -1);
    natsOptions_SetReconnectWait(made, kReconnectMs);
    natsOptions_SetReconnectJitter(made, kReconnectMs / 2, kReconnectMs / 2);
    natsOptions_SetReconnectBufSize(made, kUnsent);
    natsOptions_SetPingInterval(made, kPingMs);
    natsOptions_SetMaxPingsOut(made, kPings);
    natsOptions_SetWriteDeadline(made, kWriteMs);
    natsOptions_SetSendAsap(made, true);
    natsOptions_SetFailRequestsOnDisconnect(made, true);
    if (!from.credentials.empty())
        set(natsOptions_SetUserCredentialsFromFiles(made, from.credentials.c_str(), nullptr), "--cluster-credentials",
            from.credentials.string());
    if (from.servers.find("tls://") != std::string::npos || !from.ca.empty())
        set(natsOptions_SetSecure(made, true), "--cluster", "tls");
    if (!from.ca.empty())
        set(natsOptions_LoadCATrustedCertificates(made, from.ca.c_str()), "--cluster-ca", from.ca.string());
    if (!from.certificate.empty())
        set(natsOptions_LoadCertificatesChain(made, from.certificate.c_str(), from.key.c_str()),
            "--cluster-certificate", from.certificate.string());
    return options;
}

void setCallbacks(natsOptions* options, Link* link) {
    natsOptions_SetErrorHandler(options, told, nullptr);
    natsOptions_SetDisconnectedCB(
        options, [](natsConnection*, void* it) { linkOf(it).connected = false; }, link);
    natsOptions_SetReconnectedCB(
        options,
        [](natsConnection*, void* it) {
            ++linkOf(it).connections;
            linkOf(it).connected = true;
        },
        link);
    natsOptions_SetClosedCB(
        options,
        [](natsConnection*, void* it) {
            linkOf(it).connected = false;
            linkOf(it).closed = true;
        },
        link);
}

} // namespace brume::cluster
