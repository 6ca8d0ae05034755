// Bytes that a glTF file names: in data URIs, and in files beside it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace brume::gltf {

using Bytes = std::vector<unsigned char>;

inline constexpr size_t kMostBytes = 64 << 20; // the most of a file, of all its buffers, and of all its images

// The bytes of a plain file of at most `most` bytes. False: there is none, or it is larger.
bool readBytes(const std::filesystem::path& file, size_t most, Bytes& out);

// Reads what URIs name, within `left` bytes in all. Files lie in the folder or in one inside it.
class Sources {
public:
    explicit Sources(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // Throws Wrong, never with the data in its text.
    Bytes read(std::string_view uri);

private:
    Bytes beside(std::string_view uri);

    std::filesystem::path folder_;
    size_t left_ = kMostBytes;
};

} // namespace brume::gltf
