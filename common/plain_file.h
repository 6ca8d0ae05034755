// Files from outside.
#pragma once

#include <filesystem>
#include <fstream>

namespace brume {

// True: there is something of that name that is no plain file, such as a pipe, which to open may wait for ever.
inline bool isNoPlainFile(const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    return std::filesystem::exists(status) && !std::filesystem::is_regular_file(status);
}

// Opens a file for reading, as bytes. Only a plain one: to open a pipe or a device may wait for ever. Not good() if
// there is none, or if it cannot be read.
inline std::ifstream openPlain(const std::filesystem::path& file) {
    std::error_code error;
    std::ifstream in;
    if (std::filesystem::is_regular_file(file, error))
        in.open(file, std::ios::binary);
    else
        in.setstate(std::ios::failbit);
    return in;
}

} // namespace brume
