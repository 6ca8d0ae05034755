// The client's side of TLS: whom we trust, and that it is the server that we asked for.
#pragma once

#include <map>
#include <string>

#include "common/net/byte_stream.h"

namespace brume::client {

// One context for each PEM file of trusted certificates: the system's own take a while to read.
class TlsContexts {
public:
    // Of this file, or of the system's store when it is empty. Throws std::runtime_error, one line, when the file cannot be read.
    boost::asio::ssl::context& of(const std::string& ca);

private:
    std::map<std::string, boost::asio::ssl::context> contexts_;
};

// The certificate must be for this name or address. Returns what is wrong; empty when it is set.
std::string expectHost(ByteStream::Tls& tls, const std::string& host);

// Why the handshake failed, in words; `otherwise` when it is not the certificate.
std::string tlsFault(ByteStream::Tls& tls, boost::system::error_code error, const std::string& otherwise);

} // namespace brume::client
