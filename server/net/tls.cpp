#include "server/net/tls.h"

#include <stdexcept>

#include <fmt/format.h>

namespace brume::net {

namespace ssl = boost::asio::ssl;

Tls::Tls(const std::filesystem::path& certificate, const std::filesystem::path& key)
    : context(ssl::context::tls_server) {
    boost::system::error_code error;
    const auto check = [&](const char* option, const std::filesystem::path& file) {
        if (error)
            throw std::runtime_error(fmt::format("{} {}: {}; allowed: PEM", option, file.string(), error.message()));
    };
    SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
    // Renegotiation is off: no client needs it, and it costs the server more than the client.
    SSL_CTX_set_options(context.native_handle(), SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
    SSL_CTX_set_mode(context.native_handle(), SSL_MODE_RELEASE_BUFFERS); // idle connections keep no buffers
    context.use_certificate_chain_file(certificate.string(), error);
    check("--tls-certificate", certificate);
    // A key with a password is refused; without this OpenSSL would ask for the password on the terminal.
    context.set_password_callback([](size_t, ssl::context::password_purpose) { return std::string(); }, error);
    context.use_private_key_file(key.string(), ssl::context::pem, error);
    check("--tls-key", key);
    if (SSL_CTX_check_private_key(context.native_handle()) != 1)
        throw std::runtime_error(
            fmt::format("--tls-key {}: does not belong to the certificate {}", key.string(), certificate.string()));
}

} // namespace brume::net
