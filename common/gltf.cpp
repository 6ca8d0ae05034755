#include "common/gltf.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtc/type_ptr.hpp>

#include "common/plain_file.h"
#include "common/scene.h"
#include "common/scene_limits.h"
#include "common/text.h"
#include "common/tinygltf.h"

namespace brume {
namespace {

constexpr size_t kMostGltfBytes = 64 << 20; // of a file and the buffers beside it, together
constexpr size_t kMostValues = 200'000;     // of its JSON
constexpr int kMostDepth = 64;              // of JSON in JSON: tinygltf calls itself for each
constexpr size_t kLongestReason = 300;      // bytes, of what tinygltf says
constexpr std::string_view kBeside = "//";  // what tinygltf is told is the folder of the file

[[noreturn]] void fail(const std::string& name, std::string what) {
    while (!what.empty() && (what.back() == '\n' || what.back() == ' ')) what.pop_back();
    if (what.size() > kLongestReason) what = what.substr(0, kLongestReason) + "...";
    throw SceneError(oneLine(name + ": glTF: " + what));
}

// At most `most` bytes; false: there is no such file, or it is larger.
template <class Bytes>
bool readBytes(const std::filesystem::path& file, size_t most, Bytes& out) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) return false;
    const uint64_t size = std::filesystem::file_size(file, error);
    std::ifstream in = openPlain(file);
    if (error || !in || size > most) return false;
    out.resize(size);
    in.read(reinterpret_cast<char*>(out.data()), static_cast<std::streamsize>(size));
    out.resize(static_cast<size_t>(in.gcount()));
    return true;
}

// The files that tinygltf may read: those in the folder of the glTF file.
struct Beside {
    std::filesystem::path folder;
    size_t left = kMostGltfBytes; // bytes

    // Empty: the file may not be read.
    std::filesystem::path at(std::string_view path) const {
        if (!path.starts_with(kBeside)) return {};
        const std::filesystem::path inside = path.substr(kBeside.size());
        const bool climbs = std::ranges::find(inside, "..") != inside.end();
        const bool plain = std::ranges::none_of(path, [](unsigned char c) { return c < ' '; });
        return climbs || !plain || inside.is_absolute() ? std::filesystem::path() : folder / inside;
    }

    static bool exists(const std::string& path, void* of) {
        const std::filesystem::path file = static_cast<Beside*>(of)->at(path);
        std::error_code error;
        return !file.empty() && std::filesystem::is_regular_file(file, error);
    }
    static bool size(size_t* bytes, std::string* why, const std::string& path, void* of) {
        std::error_code error;
        *bytes = std::filesystem::file_size(static_cast<Beside*>(of)->at(path), error);
        if (error) *why = "cannot be read";
        return !error;
    }
    static std::string same(const std::string& path, void*) { return path; }
    static bool read(std::vector<unsigned char>* out, std::string* why, const std::string& path, void* of) {
        Beside& beside = *static_cast<Beside*>(of);
        const bool good = readBytes(beside.at(path), beside.left, *out);
        if (!good) *why = "cannot be read, or more than 64 MiB in all";
        beside.left -= good ? out->size() : 0;
        return good;
    }
    static bool write(std::string*, const std::string&, const std::vector<unsigned char>&, void*) { return false; }
};

// As tinygltf's version has them: from 2.9 on it asks for a file's size, too.
template <class Callbacks>
Callbacks callbacksOf(Beside& beside) {
    Callbacks callbacks{};
    callbacks.FileExists = Beside::exists;
    callbacks.ExpandFilePath = Beside::same;
    callbacks.ReadWholeFile = Beside::read;
    callbacks.WriteWholeFile = Beside::write;
    if constexpr (requires { callbacks.GetFileSizeInBytes; }) callbacks.GetFileSizeInBytes = Beside::size;
    callbacks.user_data = &beside;
    return callbacks;
}

// The JSON of a .glb's first chunk; of a .gltf all.
std::string_view jsonOf(std::string_view bytes) {
    if (!bytes.starts_with("glTF")) return bytes;
    uint32_t length = 0;
    if (bytes.size() < 20) return {};
    std::memcpy(&length, bytes.data() + 12, sizeof(length));
    return bytes.substr(20, length);
}

// Memory and stack that JSON takes grow with the number and the depth of its values.
void checkJson(const std::string& name, std::string_view json) {
    size_t values = 1;
    int depth = 0;
    bool quoted = false;
    for (size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (quoted && c == '\\')
            ++i;
        else if (c == '"')
            quoted = !quoted;
        if (quoted) continue;
        values += c == ',' || c == '{' || c == '[';
        depth += (c == '{' || c == '[') - (c == '}' || c == ']');
        if (depth > kMostDepth) fail(name, fmt::format("JSON in JSON deeper than {}", kMostDepth));
    }
    if (values > kMostValues) fail(name, fmt::format("more than {} values in its JSON", kMostValues));
}

tinygltf::Model modelOf(std::string_view bytes, const std::string& name, const std::filesystem::path& folder) {
    if (bytes.size() > kMostGltfBytes) fail(name, "larger than 64 MiB");
    checkJson(name, jsonOf(bytes));
    Beside beside{folder};
    tinygltf::TinyGLTF reader;
    reader.SetFsCallbacks(callbacksOf<tinygltf::FsCallbacks>(beside));
    reader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                             void*) { return true; },
                          nullptr);
    tinygltf::Model model;
    std::string error, warning;
    const auto size = static_cast<unsigned>(bytes.size());
    const std::string base(kBeside);
    try {
        const bool read =
            bytes.starts_with("glTF")
                ? reader.LoadBinaryFromMemory(&model, &error, &warning,
                                              reinterpret_cast<const unsigned char*>(bytes.data()), size, base)
                : reader.LoadASCIIFromString(&model, &error, &warning, bytes.data(), size, base);
        if (!read) fail(name, error.empty() ? "cannot be understood" : error);
    } catch (const std::bad_alloc&) {
        fail(name, "too little memory");
    } catch (const SceneError&) {
        throw;
    } catch (const std::exception& wrong) {
        fail(name, wrong.what());
    }
    return model;
}

class ModelReader {
public:
    ModelReader(const tinygltf::Model& model, const std::string& name, size_t most)
        : model_(model), name_(name), most_(most) {}

    Gltf read() {
        if (!model_.extensionsRequired.empty())
            fail(name_, "requires extension " + model_.extensionsRequired.front() +
                            "; export it without extensions and compression");
        readNodes();
        if (out_.triangles.empty()) fail(name_, "no triangles in its scene");
        return std::move(out_);
    }

private:
    // The element of a list that an index in the file names.
    template <class T>
    const T& at(const std::vector<T>& list, int index, const char* what) const {
        if (index < 0 || size_t(index) >= list.size())
            fail(name_, fmt::format("there is no {} {}; the file has {}", what, index, list.size()));
        return list[size_t(index)];
    }

    void readNodes() {
        const tinygltf::Scene& scene = at(model_.scenes, std::max(model_.defaultScene, 0), "scene");
        struct Visit {
            int node;
            glm::dmat4 parent;
        };
        std::vector<Visit> left;
        std::vector<bool> visited(model_.nodes.size());
        for (const int node : scene.nodes) left.push_back({node, glm::dmat4(1)});
        while (!left.empty()) {
            const auto [index, parent] = left.back();
            left.pop_back();
            const tinygltf::Node& node = at(model_.nodes, index, "node");
            if (visited[size_t(index)]) fail(name_, fmt::format("node {} is there twice, or in itself", index));
            visited[size_t(index)] = true;
            if (node.skin >= 0) fail(name_, fmt::format("node {} has a skin; export the mesh without one", index));
            const glm::dmat4 placed = parent * transformOf(node);
            if (node.mesh >= 0)
                for (const tinygltf::Primitive& part : at(model_.meshes, node.mesh, "mesh").primitives)
                    readPrimitive(part, placed);
            for (const int child : node.children) left.push_back({child, placed});
        }
    }

    static glm::dmat4 transformOf(const tinygltf::Node& node) {
        if (node.matrix.size() == 16) return glm::make_mat4(node.matrix.data());
        glm::dmat4 out(1);
        if (node.translation.size() == 3) out[3] = glm::dvec4(glm::make_vec3(node.translation.data()), 1);
        if (const auto& r = node.rotation; r.size() == 4) out *= glm::mat4_cast(glm::dquat(r[3], r[0], r[1], r[2]));
        if (const auto& s = node.scale; s.size() == 3)
            for (int axis = 0; axis < 3; ++axis) out[axis] *= s[size_t(axis)];
        return out;
    }

    // Bytes of an accessor's element `i`; the whole accessor has been checked.
    struct Column {
        const unsigned char* first;
        size_t stride, count;
        int component;

        template <class T>
        T number(size_t i, size_t part) const {
            T value;
            std::memcpy(&value, first + i * stride + part * sizeof(T), sizeof(T));
            return value;
        }
    };

    Column columnOf(int index, int type, const char* what) const {
        const tinygltf::Accessor& accessor = at(model_.accessors, index, "accessor");
        if (accessor.sparse.isSparse) fail(name_, fmt::format("accessor {} is sparse, which is not read", index));
        if (accessor.type != type) fail(name_, fmt::format("accessor {} is no list of {}", index, what));
        const tinygltf::BufferView& view = at(model_.bufferViews, accessor.bufferView, "buffer view");
        const std::vector<unsigned char>& data = at(model_.buffers, view.buffer, "buffer").data;
        const int element = tinygltf::GetComponentSizeInBytes(uint32_t(accessor.componentType)) *
                            tinygltf::GetNumComponentsInType(uint32_t(type));
        if (element <= 0) fail(name_, fmt::format("accessor {} has an unknown type", index));
        const size_t stride = view.byteStride > 0 ? view.byteStride : size_t(element);
        // Sizes below 2^32 do not overflow.
        for (const size_t size : {view.byteOffset, view.byteLength, accessor.byteOffset, accessor.count, stride})
            if (size >> 32 != 0) fail(name_, fmt::format("accessor {} is larger than its buffer", index));
        const bool fits = accessor.count > 0 && view.byteOffset + view.byteLength <= data.size() &&
                          accessor.byteOffset + (accessor.count - 1) * stride + size_t(element) <= view.byteLength;
        if (!fits) fail(name_, fmt::format("accessor {} is empty or larger than its buffer", index));
        return {data.data() + view.byteOffset + accessor.byteOffset, stride, accessor.count, accessor.componentType};
    }

    size_t vertexOf(const Column& indices, size_t i) const {
        switch (indices.component) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return indices.number<uint8_t>(i, 0);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return indices.number<uint16_t>(i, 0);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return indices.number<uint32_t>(i, 0);
        default:
            fail(name_, "indices that are no unsigned whole numbers");
        }
    }

    void readPrimitive(const tinygltf::Primitive& part, const glm::dmat4& placed) {
        if (part.mode != TINYGLTF_MODE_TRIANGLES)
            fail(name_, fmt::format("primitives of mode {}; only lists of triangles, mode 4, are read", part.mode));
        const auto position = part.attributes.find("POSITION");
        if (position == part.attributes.end()) fail(name_, "a primitive without POSITION");
        const Column places = columnOf(position->second, TINYGLTF_TYPE_VEC3, "places");
        if (places.component != TINYGLTF_COMPONENT_TYPE_FLOAT) fail(name_, "places that are no floats");
        Column indices{};
        if (part.indices >= 0) indices = columnOf(part.indices, TINYGLTF_TYPE_SCALAR, "indices");
        const size_t corners = part.indices >= 0 ? indices.count : places.count;
        if (corners % 3 != 0) fail(name_, fmt::format("{} corners are no whole number of triangles", corners));
        if (out_.triangles.size() + corners / 3 > most_)
            fail(name_, fmt::format("more than {} triangles; a scene may have {} in all", most_,
                                    size_t(limits::kTriangles.hi)));
        const glm::vec3 albedo = albedoOf(part.material);
        for (size_t i = 0; i < corners; i += 3) {
            GltfTriangle& triangle = out_.triangles.emplace_back();
            triangle.albedo = albedo;
            for (size_t c = 0; c < 3; ++c) {
                const size_t vertex = part.indices >= 0 ? vertexOf(indices, i + c) : i + c;
                if (vertex >= places.count)
                    fail(name_, fmt::format("index {} of a primitive with {} vertices", vertex, places.count));
                const glm::dvec3 place(places.number<float>(vertex, 0), places.number<float>(vertex, 1),
                                       places.number<float>(vertex, 2));
                triangle.corners[c] = placed * glm::dvec4(place, 1);
                for (int axis = 0; axis < 3; ++axis)
                    if (!std::isfinite(triangle.corners[c][axis]))
                        fail(name_, fmt::format("vertex {} is at no finite place", vertex));
            }
        }
    }

    glm::vec3 albedoOf(int material) {
        if (material < 0) return glm::vec3(1);
        const tinygltf::PbrMetallicRoughness& pbr = at(model_.materials, material, "material").pbrMetallicRoughness;
        out_.textured = out_.textured || pbr.baseColorTexture.index >= 0;
        glm::vec3 albedo(1);
        for (size_t c = 0; c < std::min<size_t>(pbr.baseColorFactor.size(), 3); ++c) {
            if (!limits::kColour.holds(pbr.baseColorFactor[c]))
                fail(name_, fmt::format("material {} has a base colour factor of {}; allowed: 0 to 1", material,
                                        pbr.baseColorFactor[c]));
            albedo[int(c)] = float(pbr.baseColorFactor[c]);
        }
        return albedo;
    }

    const tinygltf::Model& model_;
    const std::string& name_;
    size_t most_;
    Gltf out_;
};

} // namespace

Gltf loadGltf(const std::filesystem::path& file, size_t most) {
    std::error_code error;
    if (!std::filesystem::exists(file, error) && !error)
        fail(file.string(), "no such file; a relative mesh.file counts from the scene's folder");
    std::string bytes;
    if (!readBytes(file, kMostGltfBytes, bytes)) fail(file.string(), "cannot be read, or larger than 64 MiB");
    return parseGltf(bytes, file.string(), file.parent_path(), most);
}

Gltf parseGltf(std::string_view bytes, const std::string& name, const std::filesystem::path& folder, size_t most) {
    const tinygltf::Model model = modelOf(bytes, name, folder);
    return ModelReader(model, name, most).read();
}

} // namespace brume
