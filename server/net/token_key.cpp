#include "server/net/token_key.h"

#include <stdexcept>

#include <fmt/format.h>

#include "server/net/secret_file.h"
#include "server/net/token.h"

namespace brume {

std::string readTokenKey(const std::filesystem::path& file) {
    std::error_code unknown; // why the file cannot be looked for; readSecret() says the same of reading it
    if (!std::filesystem::exists(file, unknown) && !unknown)
        throw std::runtime_error(
            fmt::format("--token-key {0}: there is no such file; make one: (umask 077; head -c 32 /dev/urandom > {0})",
                        file.string()));
    std::string key = readSecret("--token-key", file, net::kMostKeyBytes);
    if (key.size() < net::kLeastKeyBytes || key.size() > net::kMostKeyBytes)
        throw std::runtime_error(
            fmt::format("--token-key {}: allowed: {} to {} bytes of secret (head -c 32 /dev/urandom)", file.string(),
                        net::kLeastKeyBytes, net::kMostKeyBytes));
    return key;
}

} // namespace brume
