// Who may be believed: NATS servers that strangers may reach, and the hosts that viewers may be sent to.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/cluster/options.h"

namespace brume::cluster {

// What stands between the commas; parts that are empty are left out.
std::vector<std::string> listOf(std::string_view list);

// The host of a URL, in small letters, without user, password, port and brackets: "SCHEME://USER:PASSWORD@HOST:PORT/".
// Empty: there is none.
std::string hostOf(std::string_view url);

// The first of EngineOptions::servers that others than this machine may reach and that asks nobody who they are, as far
// as the options tell. They tell otherwise with a user and a password or a token in the URL, with credentials, or with
// a certificate to show. Without secrets; empty: there is no such server.
std::string openServer(const EngineOptions& options);

// Hosts that viewers of this server may be sent to.
class Hosts {
public:
    // `listed`: names and addresses, and "*.DOMAIN" for all names below one, divided by commas. `own`: where viewers
    // reach this server; its host is allowed, too. Where that is this machine, so are all names of this machine.
    Hosts(std::string_view listed, std::string_view own);
    // False, too, for a URL that browsers might read otherwise: with a user, a backslash, or what is no plain
    // character.
    bool allow(std::string_view url) const;

private:
    std::vector<std::string> listed_;
    std::string own_;
};

} // namespace brume::cluster
