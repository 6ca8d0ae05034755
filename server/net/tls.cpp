#include "server/net/tls.h"

#include <stdexcept>

#include <boost/asio/buffer.hpp>
#include <fmt/format.h>
#include <openssl/crypto.h>

#include "common/plain_file.h"
#include "server/net/secret_file.h"

namespace brume::net {

namespace ssl = boost::asio::ssl;

constexpr size_t kMostTlsKeyBytes = 64 << 10; // of the file

Tls::Tls(const std::filesystem::path& certificate, const std::filesystem::path& key)
    : context(ssl::context::tls_server) {
    boost::system::error_code error;
    const auto check = [&](const char* option, const std::filesystem::path& file) {
        if (error)
            throw std::runtime_error(fmt::format("{} {}: {}; allowed: PEM", option, file.string(), error.message()));
    };
    SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
    // Forward secrecy: who steals the key later reads nothing that was said before. TLS 1.3 has nothing else.
    SSL_CTX_set_cipher_list(context.native_handle(), "ECDHE+AESGCM:ECDHE+CHACHA20");
    // Renegotiation is off: no client needs it, and it costs the server more than the client.
    SSL_CTX_set_options(context.native_handle(), SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
    SSL_CTX_set_mode(context.native_handle(), SSL_MODE_RELEASE_BUFFERS); // idle connections keep no buffers
    if (isNoPlainFile(certificate))
        throw std::runtime_error(fmt::format("--tls-certificate {}: is not a file", certificate.string()));
    context.use_certificate_chain_file(certificate.string(), error);
    check("--tls-certificate", certificate);
    // A key with a password is refused; without this OpenSSL would ask for the password on the terminal.
    context.set_password_callback([](size_t, ssl::context::password_purpose) { return std::string(); }, error);
    std::string secret = readSecret("--tls-key", key, kMostTlsKeyBytes);
    context.use_private_key(boost::asio::buffer(secret), ssl::context::pem, error);
    OPENSSL_cleanse(secret.data(), secret.size());
    check("--tls-key", key);
    if (SSL_CTX_check_private_key(context.native_handle()) != 1)
        throw std::runtime_error(
            fmt::format("--tls-key {}: does not belong to the certificate {}", key.string(), certificate.string()));
}

} // namespace brume::net
