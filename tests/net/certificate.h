// A certificate for a test's own server, vouched for by itself.
#pragma once

#include <filesystem>
#include <string>

namespace brume::test {

// A folder of its own with certificate.pem and key.pem for 127.0.0.1 and localhost; gone with the object.
class Certificate {
public:
    Certificate();
    ~Certificate();
    Certificate(const Certificate&) = delete;
    Certificate& operator=(const Certificate&) = delete;

    std::string certificate() const { return (folder_ / "certificate.pem").string(); }
    std::string key() const { return (folder_ / "key.pem").string(); }
    // Another in its place, with another key. Returns its serial number.
    long renew();

private:
    std::filesystem::path folder_;
    long serial_ = 0;
};

} // namespace brume::test
