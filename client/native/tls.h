// The client's side of TLS: which certificates are trusted, and whether the server's is for the name that was asked
// for.
#pragma once

#include <map>
#include <string>

#include "protocol/net/byte_stream.h"

namespace brume::client {

// TLS contexts, one for each PEM file of trusted certificates. They are kept, since the system's own take long to
// read.
class TlsContexts {
public:
    // The context that trusts the certificates of this file, or the system's if `ca` is empty. Throws
    // std::runtime_error, one line, if the file cannot be read.
    boost::asio::ssl::context& of(const std::string& ca);

private:
    std::map<std::string, boost::asio::ssl::context> contexts_;
};

// From now on the handshake fails unless the certificate is for this name or address. Returns an error in one line,
// or nothing.
std::string expectHost(ByteStream::Tls& tls, const std::string& host);

// Why the handshake failed, in words: what is wrong with the certificate, or `otherwise`.
std::string tlsFault(ByteStream::Tls& tls, boost::system::error_code error, const std::string& otherwise);

} // namespace brume::client
