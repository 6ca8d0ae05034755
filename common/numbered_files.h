// The files of a sequence, by the numbers in their names.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

namespace brume {

inline constexpr size_t kMostFiles = 10'000; // of a sequence

// Files of the name `pattern`, whose run of # stands for as many digits, by number.
// Throws SceneError if there are none or too many.
std::vector<std::pair<uint64_t, std::filesystem::path>> numberedFiles(const std::filesystem::path& pattern);
// The name of a file of that number: the pattern with as many digits for its run of #, or more if they are needed.
std::filesystem::path numberedFile(const std::filesystem::path& pattern, uint64_t number);
// The first of them with points, or else the first. Throws SceneError for a file before it that cannot be read.
std::filesystem::path firstWithPoints(const std::filesystem::path& pattern);

} // namespace brume
