// glTF files for tests of loading.
#pragma once

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include <nlohmann/json.hpp>

namespace brume::test {

// One triangle in the plane z = 0 with indices, as JSON and the bytes of its buffer. Tests change it.
struct GltfFile {
    nlohmann::json json = nlohmann::json::parse(R"({
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": 44}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.125, 1]}}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0})");
    std::vector<float> places{0, 0, 0, 1, 0, 0, 0, 1, 0};
    std::vector<uint16_t> indices{0, 1, 2};
    std::string more; // bytes behind them

    nlohmann::json& primitive() { return json["meshes"][0]["primitives"][0]; }

    // Four corners of the unit cube in a list and two triangles of them, instead of the one.
    static GltfFile square() {
        GltfFile file;
        file.primitive()["attributes"]["POSITION"] =
            file.add(std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1}, "VEC3", 4);
        file.primitive()["indices"] = file.add(std::vector<uint16_t>{0, 1, 2, 0, 2, 3}, "SCALAR", 6);
        return file;
    }

    // The index of a new view of these bytes.
    size_t addView(std::string bytes) {
        const size_t begin = 44 + more.size();
        json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", begin}, {"byteLength", bytes.size()}});
        bytes.resize((bytes.size() + 3) / 4 * 4);
        more += bytes;
        json["buffers"][0]["byteLength"] = begin + bytes.size();
        return json["bufferViews"].size() - 1;
    }

    // The index of a new accessor of these numbers.
    template <class T>
    size_t add(const std::vector<T>& numbers, const char* type, size_t count, bool normalized = false) {
        const int component = std::is_same_v<T, float>      ? 5126
                              : std::is_same_v<T, uint32_t> ? 5125
                              : std::is_same_v<T, uint16_t> ? 5123
                              : std::is_same_v<T, int16_t>  ? 5122
                              : std::is_same_v<T, uint8_t>  ? 5121
                                                            : 5120;
        const size_t view = addView({reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T)});
        json["accessors"].push_back({{"bufferView", view},
                                     {"componentType", component},
                                     {"count", count},
                                     {"type", type},
                                     {"normalized", normalized}});
        return json["accessors"].size() - 1;
    }

    std::string buffer() const {
        std::string out(44, '\0');
        std::memcpy(out.data(), places.data(), 36);
        std::memcpy(out.data() + 36, indices.data(), 6);
        return out + more;
    }
    std::string glb() const {
        std::string text = json.dump();
        text.resize((text.size() + 3) / 4 * 4, ' ');
        const std::string data = buffer();
        std::string out = "glTF";
        const auto put = [&](size_t number) {
            const auto word = uint32_t(number);
            out.append(reinterpret_cast<const char*>(&word), 4);
        };
        put(2), put(28 + text.size() + data.size()), put(text.size()), out += "JSON";
        out += text;
        put(data.size());
        out += std::string("BIN\0", 4) + data;
        return out;
    }
};

} // namespace brume::test
