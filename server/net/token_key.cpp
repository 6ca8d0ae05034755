#include "server/net/token_key.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "server/net/token.h"

namespace brume {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
    throw std::runtime_error(fmt::format("--token-key: {}: {}", file.string(), what));
}

struct Descriptor {
    const int fd;
    ~Descriptor() {
        if (fd >= 0) ::close(fd);
    }
};

} // namespace

std::string readTokenKey(const std::filesystem::path& file) {
    // The open descriptor is checked, so that the file that is checked is the one that is read. O_NONBLOCK: opening a
    // pipe would wait for its writer.
    const Descriptor in{::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    struct stat about {};
    if (in.fd < 0 || ::fstat(in.fd, &about) != 0) refuse(file, std::strerror(errno));
    if (!S_ISREG(about.st_mode)) refuse(file, "is not a file");
    if ((about.st_mode & S_IRWXO) != 0 || (about.st_mode & S_IWGRP) != 0)
        refuse(file, "others may read or change it; allowed: its owner alone, or its group reading (chmod 600)");
    std::vector<char> bytes(net::kMostKeyBytes + 1);
    size_t size = 0;
    while (size < bytes.size()) {
        const ssize_t got = ::read(in.fd, bytes.data() + size, bytes.size() - size);
        if (got < 0) refuse(file, std::strerror(errno));
        if (got == 0) break;
        size += size_t(got);
    }
    if (size < net::kLeastKeyBytes || size > net::kMostKeyBytes)
        refuse(file, fmt::format("allowed: {} to {} bytes of secret (head -c 32 /dev/urandom)", net::kLeastKeyBytes,
                                 net::kMostKeyBytes));
    return {bytes.begin(), bytes.begin() + std::ptrdiff_t(size)};
}

} // namespace brume
