#include "common/numbered_files.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "common/ply/ply.h"
#include "common/scene.h"
#include "common/text.h"

namespace brume {

namespace {

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
    throw SceneError(oneLine(file.string() + ": " + what));
}

// The number in a file's name that is made as `pattern` says; nothing for other names.
std::optional<uint64_t> numberOf(const std::string& name, const std::string& pattern) {
    const size_t begin = pattern.find('#'), end = pattern.find_last_of('#') + 1;
    if (name.size() != pattern.size() || name.compare(0, begin, pattern, 0, begin) != 0 ||
        name.compare(end, name.npos, pattern, end, pattern.npos) != 0)
        return {};
    uint64_t number = 0;
    const auto [stop, error] = std::from_chars(&name[begin], &name[end - 1] + 1, number);
    return error == std::errc() && stop == &name[end - 1] + 1 ? std::optional(number) : std::nullopt;
}

} // namespace

std::vector<std::pair<uint64_t, std::filesystem::path>> numberedFiles(const std::filesystem::path& pattern) {
    std::vector<std::pair<uint64_t, std::filesystem::path>> found;
    const std::string name = pattern.filename().string();
    const std::filesystem::path folder = pattern.has_parent_path() ? pattern.parent_path() : ".";
    std::error_code error;
    for (std::filesystem::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        const auto number = numberOf(i->path().filename().string(), name);
        if (!number) continue;
        if (found.size() == kMostFiles)
            fail(pattern, fmt::format("more than {} files; leave some out, or merge them", kMostFiles));
        found.emplace_back(*number, i->path());
    }
    if (error) fail(pattern, "the folder cannot be read: " + error.message());
    if (found.empty()) fail(pattern, "no such file; expected numbered files, with a digit for each #");
    std::sort(found.begin(), found.end());
    return found;
}

std::filesystem::path numberedFile(const std::filesystem::path& pattern, uint64_t number) {
    std::string name = pattern.filename().string();
    const size_t begin = std::min(name.find('#'), name.size()), length = name.find_last_of('#') + 1 - begin;
    return pattern.parent_path() / name.replace(begin, length, fmt::format("{:0{}}", number, length));
}

std::filesystem::path firstWithPoints(const std::filesystem::path& pattern) {
    const auto files = numberedFiles(pattern);
    for (const auto& [number, file] : files)
        if (holdsPoints(file)) return file;
    return files.front().second;
}

} // namespace brume
