#include <sys/mman.h>
#include <unistd.h>

#include <string>

#include "tests/fuzz/promise.h"

namespace brume::fuzz {

const char* asFile(Bytes bytes) {
    static const int file = memfd_create("fuzz", MFD_CLOEXEC);
    static const std::string path = "/proc/self/fd/" + std::to_string(file);
    promise(file >= 0 && ftruncate(file, 0) == 0, "memory for a file");
    promise(pwrite(file, bytes.data(), bytes.size(), 0) == ssize_t(bytes.size()), "memory for a file");
    return path.c_str();
}

} // namespace brume::fuzz
