// The file with the key of tokens (token.h).
#pragma once

#include <filesystem>
#include <string>

namespace brume {

// All bytes of the file. Throws std::runtime_error, in one line that says what is allowed, as readSecret() does
// (secret_file.h), and if the file is shorter than 32 bytes or longer than 4096.
std::string readTokenKey(const std::filesystem::path& file);

} // namespace brume
