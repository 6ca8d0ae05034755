// read_gltf FILE_OR_FOLDER...: reads every .glb and .gltf file and prints a line for each: its triangles and the box
// around them, or why it is refused; then lines on what was left out. Built with sanitizers it judges a collection of
// files, such as the fixtures of Khronos' glTF-Validator:
//     cmake --preset asan && ninja -C build/asan read_gltf && build/asan/bin/read_gltf glTF-Validator/test
// It fails where a refusal is not one short line.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "common/gltf/gltf.h"
#include "common/scene.h"
#include "common/scene_limits.h"

namespace brume {
namespace {

constexpr size_t kLongestLine = 1000; // bytes, with the file's name

bool isOneLine(const std::string& text) {
    return !text.empty() && text.size() <= kLongestLine &&
           std::ranges::none_of(text, [](unsigned char c) { return c < ' ' || c == 127; });
}

std::vector<std::filesystem::path> filesIn(const std::filesystem::path& place) {
    if (!std::filesystem::is_directory(place)) return {place};
    std::vector<std::filesystem::path> out;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(place))
        if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") out.push_back(entry.path());
    std::ranges::sort(out);
    return out;
}

// False: what it says is no line.
bool tell(const std::filesystem::path& file, size_t& read) {
    try {
        const Gltf gltf = loadGltf(file, size_t(limits::kTriangles.hi));
        glm::dvec3 lo(1e300), hi(-1e300);
        for (const GltfTriangle& triangle : gltf.triangles)
            for (const glm::dvec3& corner : triangle.corners) lo = glm::min(lo, corner), hi = glm::max(hi, corner);
        const glm::vec3 albedo = gltf.triangles.front().albedo;
        std::cout << fmt::format(
            "{}: {} triangles in [{:.4g}, {:.4g}, {:.4g}] to [{:.4g}, {:.4g}, {:.4g}], the first of albedo "
            "({:.4g}, {:.4g}, {:.4g})\n",
            file.string(), gltf.triangles.size(), lo.x, lo.y, lo.z, hi.x, hi.y, hi.z, albedo.x, albedo.y, albedo.z);
        for (const std::string& line : gltf.told) std::cout << "    " << line << '\n';
        ++read;
        return std::ranges::all_of(gltf.told, isOneLine);
    } catch (const SceneError& error) {
        std::cout << error.what() << '\n';
        return isOneLine(error.what());
    }
}

} // namespace
} // namespace brume

int main(int count, char** arguments) {
    size_t files = 0, read = 0, wrong = 0;
    for (int i = 1; i < count; ++i)
        for (const std::filesystem::path& file : brume::filesIn(arguments[i])) {
            ++files;
            if (brume::tell(file, read)) continue;
            std::cout << "    is no line\n";
            ++wrong;
        }
    std::cout << fmt::format("{} files: {} are read, {} are refused, {} of them not by one line\n", files, read,
                             files - read, wrong);
    return files == 0 || wrong > 0 ? 1 : 0;
}
