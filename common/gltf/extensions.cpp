#include "common/gltf/extensions.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

namespace brume::gltf {
namespace {

constexpr size_t kLongestName = 60; // bytes, in a message
constexpr size_t kMostNames = 8;    // in a line

// Extensions whose content is read.
constexpr std::array<std::string_view, 5> kRead{"KHR_mesh_quantization", "KHR_texture_transform",
                                                "KHR_materials_pbrSpecularGlossiness", "KHR_node_visibility",
                                                "EXT_mesh_gpu_instancing"};

// Those that each place where they are used is told of.
constexpr std::array<std::string_view, 2> kToldWhereUsed{"KHR_materials_transmission", "KHR_materials_volume"};

// Beginnings of names of extensions that change no place of a vertex.
constexpr std::array<std::string_view, 22> kWithoutGeometry{"KHR_materials_",
                                                            "KHR_lights_",
                                                            "KHR_texture_",
                                                            "KHR_xmp",
                                                            "KHR_animation_",
                                                            "KHR_techniques_webgl",
                                                            "KHR_interactivity",
                                                            "KHR_node_",
                                                            "KHR_audio",
                                                            "EXT_texture_",
                                                            "EXT_lights_",
                                                            "EXT_mesh_features",
                                                            "EXT_structural_metadata",
                                                            "EXT_instance_features",
                                                            "EXT_feature_metadata",
                                                            "MSFT_texture_",
                                                            "MSFT_packing_",
                                                            "MSFT_lod",
                                                            "ADOBE_materials_",
                                                            "NV_materials_",
                                                            "CESIUM_primitive_outline",
                                                            "VRM"};

bool isRead(std::string_view name) { return std::ranges::find(kRead, name) != kRead.end(); }

bool changesGeometry(std::string_view name) {
    return !isRead(name) &&
           std::ranges::none_of(kWithoutGeometry, [&](std::string_view begin) { return name.starts_with(begin); });
}

std::vector<std::string> namesIn(const Json& root, const char* key) {
    std::vector<std::string> names;
    for (const Json& name : listIn(root, key)) {
        if (!name.is_string()) fail("{} holds something that is no name", key);
        names.push_back(name.get<std::string>());
    }
    return names;
}

} // namespace

void checkExtensions(const Json& root, Told& told) {
    const std::vector<std::string> required = namesIn(root, "extensionsRequired");
    for (const std::string& name : required)
        if (changesGeometry(name))
            fail("requires extension {}; export it without that extension, and without compression",
                 shortened(name, kLongestName));
    std::vector<std::string> ignored = namesIn(root, "extensionsUsed");
    ignored.insert(ignored.end(), required.begin(), required.end());
    std::ranges::sort(ignored);
    ignored.erase(std::unique(ignored.begin(), ignored.end()), ignored.end());
    std::erase_if(ignored, [](const std::string& name) {
        return isRead(name) || std::ranges::find(kToldWhereUsed, name) != kToldWhereUsed.end();
    });
    std::string line;
    for (size_t i = 0; i < std::min(ignored.size(), kMostNames); ++i)
        line += (i ? ", " : "") + shortened(ignored[i], kLongestName);
    if (ignored.size() > kMostNames) line += fmt::format(" and {} more", ignored.size() - kMostNames);
    if (!line.empty()) told.add("ignored extensions: " + line);
}

} // namespace brume::gltf
