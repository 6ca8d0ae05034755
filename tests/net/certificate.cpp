#include "tests/net/certificate.h"

#include <cstdio>
#include <memory>
#include <stdexcept>

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>
#include <unistd.h>

namespace brume::test {
namespace {

template <auto Free>
struct With {
    template <class T>
    void operator()(T* it) const {
        Free(it);
    }
};
using Key = std::unique_ptr<EVP_PKEY, With<EVP_PKEY_free>>;
using X509Certificate = std::unique_ptr<X509, With<X509_free>>;
using Extension = std::unique_ptr<X509_EXTENSION, With<X509_EXTENSION_free>>;

void expect(bool done) {
    if (!done) throw std::runtime_error("OpenSSL makes no certificate");
}

template <class Write>
void save(const std::string& file, Write&& write) {
    const std::unique_ptr<FILE, With<std::fclose>> out(std::fopen(file.c_str(), "w"));
    expect(out && write(out.get()) == 1);
}

} // namespace

Certificate::Certificate() {
    std::string folder = (std::filesystem::temp_directory_path() / "brume-tls-XXXXXX").string();
    expect(mkdtemp(folder.data()) != nullptr);
    folder_ = folder;
    renew();
}

Certificate::~Certificate() { std::filesystem::remove_all(folder_); }

long Certificate::renew(Kind kind) {
    const Key pair(kind == Kind::rsa ? EVP_RSA_gen(2048) : EVP_EC_gen("P-256"));
    const X509Certificate x509(X509_new());
    expect(pair && x509);
    expect(X509_set_version(x509.get(), X509_VERSION_3) == 1);
    expect(ASN1_INTEGER_set(X509_get_serialNumber(x509.get()), ++serial_) == 1);
    X509_gmtime_adj(X509_getm_notBefore(x509.get()), -3600);
    X509_gmtime_adj(X509_getm_notAfter(x509.get()), 3600);
    expect(X509_set_pubkey(x509.get(), pair.get()) == 1);
    X509_NAME* const name = X509_get_subject_name(x509.get());
    expect(X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_ASC, reinterpret_cast<const unsigned char*>("localhost"), -1,
                                      -1, 0));
    expect(X509_set_issuer_name(x509.get(), name) == 1);
    const Extension names(X509V3_EXT_conf_nid(nullptr, nullptr, NID_subject_alt_name, "DNS:localhost,IP:127.0.0.1"));
    expect(names && X509_add_ext(x509.get(), names.get(), -1) == 1);
    expect(X509_sign(x509.get(), pair.get(), EVP_sha256()) > 0);
    save(certificate(), [&](FILE* out) { return PEM_write_X509(out, x509.get()); });
    save(key(),
         [&](FILE* out) { return PEM_write_PrivateKey(out, pair.get(), nullptr, nullptr, 0, nullptr, nullptr); });
    std::filesystem::permissions(key(), std::filesystem::perms(0600));
    return serial_;
}

} // namespace brume::test
