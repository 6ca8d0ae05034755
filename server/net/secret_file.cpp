#include "server/net/secret_file.h"

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

namespace brume {
namespace {

struct Descriptor {
    const int fd;
    ~Descriptor() {
        if (fd >= 0) ::close(fd);
    }
};

} // namespace

std::string readSecret(const char* option, const std::filesystem::path& file, size_t most) {
    const auto refuse = [&](const char* what) {
        throw std::runtime_error(fmt::format("{} {}: {}", option, file.string(), what));
    };
    // The open descriptor is checked, so that the file that is checked is the one that is read. O_NONBLOCK: opening a
    // pipe would wait for its writer.
    const Descriptor in{::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    struct stat about {};
    if (in.fd < 0 || ::fstat(in.fd, &about) != 0) refuse(std::strerror(errno));
    if (!S_ISREG(about.st_mode)) refuse("is not a file");
    if ((about.st_mode & S_IRWXO) != 0 || (about.st_mode & S_IWGRP) != 0)
        refuse("others may read or change it; allowed: its owner alone, or its group reading (chmod 600)");
    std::string bytes(most + 1, '\0');
    size_t size = 0;
    while (size < bytes.size()) {
        const ssize_t got = ::read(in.fd, bytes.data() + size, bytes.size() - size);
        if (got < 0) refuse(std::strerror(errno));
        if (got == 0) break;
        size += size_t(got);
    }
    bytes.resize(size);
    return bytes;
}

} // namespace brume
