// The groups of brume-server's options, a file for each. A function binds a group's options to where their values go,
// and the order in which they are called is that of --help.
#pragma once

#include "server/options/option_group.h"
#include "server/options/options.h"

namespace brume {

void addSceneOptions(OptionTable& table, ServerOptions& o);
void addNetworkOptions(OptionTable& table, ServerOptions& o);
void addTrustOptions(OptionTable& table, ServerOptions& o);
void addLimitOptions(OptionTable& table, ServerOptions& o);
void addStopOptions(OptionTable& table, ServerOptions& o);
void addDeviceOptions(OptionTable& table, ServerOptions& o);
void addLogOptions(OptionTable& table, ServerOptions& o);
void addRecordOptions(OptionTable& table, ServerOptions& o);
void addClusterOptions(OptionTable& table, ServerOptions& o);

// Reads the token key. Throws std::runtime_error, in one line, when the trust options contradict each other, and when
// other machines could connect, also through a gateway, without a key and nobody said --open.
void readTrust(ServerOptions& o);

// What is allowed instead of this URL, which viewers are told; empty: it is good.
std::string checkViewerUrl(const std::string& url);

// --make-token, and what belongs to it.
struct TokenRequest {
    std::string role;       // empty: no token is wanted
    std::string name, room; // empty: none
    uint32_t valid_s = 3600;
};
void addTokenOptions(OptionTable& table, TokenRequest& request);
// Throws std::runtime_error without a key.
std::string makeToken(const TokenRequest& request, const std::string& key);

} // namespace brume
