#include "common/gltf/gltf.h"

#include <algorithm>
#include <new>

#include "common/gltf/primitives.h"
#include "common/scene.h"
#include "common/text.h"

namespace brume {
namespace {

[[noreturn]] void refuse(const std::string& name, const std::string& what) {
    constexpr size_t kLongest = 300; // bytes
    throw SceneError(oneLine(name + ": glTF: ") + gltf::shortened(what, kLongest));
}

} // namespace

Gltf loadGltf(const std::filesystem::path& file, size_t most) {
    std::error_code error;
    if (!std::filesystem::exists(file, error) && !error)
        refuse(file.string(), "no such file; a relative mesh.file counts from the scene's folder");
    gltf::Bytes bytes;
    if (!gltf::readBytes(file, gltf::kMostBytes, bytes))
        refuse(file.string(), fmt::format("cannot be read, or larger than {} MiB", gltf::kMostBytes >> 20));
    return parseGltf({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file.string(), file.parent_path(),
                     most);
}

Gltf parseGltf(std::string_view bytes, const std::string& name, const std::filesystem::path& folder, size_t most) {
    try {
        gltf::File file(bytes, folder);
        std::vector<GltfTriangle> triangles = gltf::trianglesOf(file, most);
        std::vector<std::string> told = file.told.lines();
        if (triangles.empty()) {
            const auto why = std::ranges::find_if(
                told, [](const std::string& line) { return line.find("left out") != std::string::npos; });
            gltf::fail("no triangles in its scene{}", why == told.end() ? "" : ": " + *why);
        }
        return {std::move(triangles), std::move(told)};
    } catch (const gltf::Wrong& wrong) {
        refuse(name, wrong.what());
    } catch (const std::bad_alloc&) {
        refuse(name, "too little memory");
    }
}

} // namespace brume
