// Certificate: a self-signed TLS certificate for a test server.
#pragma once

#include <filesystem>
#include <string>

namespace brume::test {

// A temporary folder with certificate.pem and key.pem for 127.0.0.1 and localhost. The destructor removes it.
class Certificate {
public:
    Certificate();
    ~Certificate();
    Certificate(const Certificate&) = delete;
    Certificate& operator=(const Certificate&) = delete;

    std::string certificate() const { return (folder_ / "certificate.pem").string(); }
    std::string key() const { return (folder_ / "key.pem").string(); }
    // Replaces certificate and key by new ones. Returns the new serial number.
    enum class Kind { ecdsa, rsa };
    long renew(Kind kind = Kind::ecdsa);

private:
    std::filesystem::path folder_;
    long serial_ = 0;
};

} // namespace brume::test
