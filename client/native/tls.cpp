#include "client/native/tls.h"

#include <stdexcept>

#include <boost/asio/ip/address.hpp>
#include <boost/asio/ssl/error.hpp>
#include <boost/asio/ssl/host_name_verification.hpp>

namespace brume::client {

namespace ssl = boost::asio::ssl;

ssl::context& TlsContexts::of(const std::string& ca) {
    if (const auto known = contexts_.find(ca); known != contexts_.end()) return known->second;
    ssl::context context(ssl::context::tls_client);
    SSL_CTX_set_min_proto_version(context.native_handle(), TLS1_2_VERSION);
    context.set_verify_mode(ssl::verify_peer);
    boost::system::error_code error;
    if (ca.empty())
        context.set_default_verify_paths(error);
    else
        context.load_verify_file(ca, error);
    if (error)
        throw std::runtime_error((ca.empty() ? "the system's trusted certificates" : "--ca '" + ca + "'") +
                                 " cannot be read: " + error.message());
    return contexts_.emplace(ca, std::move(context)).first->second;
}

std::string expectHost(ByteStream::Tls& tls, const std::string& host) {
    boost::system::error_code error, no_address;
    boost::asio::ip::make_address(host, no_address);
    // A server with several certificates is told which; an address is not told (RFC 6066).
    if (no_address && SSL_set_tlsext_host_name(tls.native_handle(), host.c_str()) != 1)
        return "the name is too long for TLS";
    tls.set_verify_callback(ssl::host_name_verification(host), error);
    return error ? error.message() : "";
}

std::string tlsFault(ByteStream::Tls& tls, boost::system::error_code error, const std::string& otherwise) {
    const long verdict = SSL_get_verify_result(tls.native_handle());
    if (error.category() != boost::asio::error::get_ssl_category()) return otherwise;
    if (verdict != X509_V_OK)
        return std::string("its certificate is not trusted: ") + X509_verify_cert_error_string(verdict);
    return otherwise;
}

} // namespace brume::client
