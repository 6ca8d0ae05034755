// A file with a secret: the key of tokens, the private key of the certificate.
#pragma once

#include <filesystem>
#include <string>

namespace brume {

// Its bytes, `most` + 1 at most. Throws std::runtime_error, in one line that begins with `option`, if the file cannot
// be read, or if others than its owner and group may read it or others than its owner may change it.
std::string readSecret(const char* option, const std::filesystem::path& file, size_t most);

} // namespace brume
