// The file with the key of tokens (token.h).
#pragma once

#include <filesystem>
#include <string>

namespace brume {

// All bytes of the file. Throws std::runtime_error, in one line that says what is allowed, if the file cannot be read,
// is shorter than 32 bytes or longer than 4096, or if others than its owner and group may read or change it.
std::string readTokenKey(const std::filesystem::path& file);

} // namespace brume
