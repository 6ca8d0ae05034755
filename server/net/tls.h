// The server's side of TLS: its certificate and protocol versions.
#pragma once

#include <filesystem>
#include <memory>

#include <boost/asio/ssl/context.hpp>

namespace brume::net {

class Tls {
public:
    // TLS 1.2 with forward secrecy, or newer, with the chain and the key in these PEM files. Throws std::runtime_error,
    // in one line, if they cannot be read or do not belong together, or if others may read the key (secret_file.h).
    Tls(const std::filesystem::path& certificate, const std::filesystem::path& key);

    boost::asio::ssl::context context;
};

} // namespace brume::net
