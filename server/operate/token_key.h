// The file that holds the key of tokens (server/net/token.h).
#pragma once

#include <filesystem>
#include <string>

namespace brume {

// All of its bytes. Throws std::runtime_error, in one line that says what is allowed, when it cannot be read, is shorter than 32
// bytes or longer than 4096, or when its permissions let others than owner and group read or change it.
std::string readTokenKey(const std::filesystem::path& file);

} // namespace brume
