#include "common/gltf/file.h"

#include <cstdlib>
#include <cstring>
#include <string>

#include "common/gltf/extensions.h"

namespace brume::gltf {
namespace {

constexpr uint32_t kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942; // "JSON", "BIN"

struct Parts {
    std::string_view json;
    ByteSpan binary;
};

uint32_t wordAt(std::string_view bytes, size_t at) {
    uint32_t word = 0;
    std::memcpy(&word, bytes.data() + at, sizeof(word));
    return word;
}

// A .glb: 12 bytes, then chunks of 8 bytes and their data, the JSON first.
Parts partsOf(std::string_view bytes) {
    if (bytes.empty()) fail("an empty file");
    if (!bytes.starts_with("glTF")) return {bytes, {}};
    if (bytes.size() < 20) fail("too short for a .glb file");
    if (const uint32_t version = wordAt(bytes, 4); version != 2)
        fail("a .glb file of version {}; export it as glTF 2.0", version);
    const size_t size = wordAt(bytes, 8);
    if (size > bytes.size()) fail("{} bytes are there of the {} that the .glb file should have", bytes.size(), size);
    Parts out;
    for (size_t at = 12, chunk = 0; at + 8 <= size; ++chunk) {
        const size_t length = wordAt(bytes, at);
        const uint32_t type = wordAt(bytes, at + 4);
        at += 8;
        if (length > size - at) fail("chunk {} is longer than the .glb file", chunk);
        if (chunk == 0 && type != kJsonChunk) fail("the first chunk of the .glb file is no JSON");
        if (chunk == 0) out.json = bytes.substr(at, length);
        if (type == kBinaryChunk && out.binary.empty())
            out.binary = {reinterpret_cast<const unsigned char*>(bytes.data()) + at, length};
        at += (length + 3) / 4 * 4;
    }
    return out;
}

// Major and minor number of "2.0"; 0 where it is none.
std::pair<unsigned long, unsigned long> versionOf(const std::string& text) {
    char* end = nullptr;
    const unsigned long major = std::strtoul(text.c_str(), &end, 10);
    return {major, *end == '.' ? std::strtoul(end + 1, nullptr, 10) : 0};
}

void checkVersion(const Json& root) {
    constexpr size_t kLongest = 20; // bytes, in a message
    const Json& asset = member(root, "asset");
    if (!asset.is_object()) fail("has no asset with a version; expected a glTF 2.0 file");
    const std::string version = textIn(asset, "version"), least = textIn(asset, "minVersion");
    if (version.empty()) fail("asset has no version; expected a glTF 2.0 file");
    if (versionOf(version).first != 2)
        fail("asset.version is \"{}\", another format; export it as glTF 2.0", shortened(version, kLongest));
    if (!least.empty() && versionOf(least) > std::pair(2ul, 0ul))
        fail("asset.minVersion is \"{}\"; allowed: 2.0, export it so", shortened(least, kLongest));
}

} // namespace

File::File(std::string_view bytes, const std::filesystem::path& folder)
    : buffer_sources_(folder), image_sources_(folder) {
    if (bytes.size() > kMostBytes) fail("larger than {} MiB", kMostBytes >> 20);
    const Parts parts = partsOf(bytes);
    root_ = parsed(parts.json);
    binary_ = parts.binary;
    checkVersion(root_);
    checkExtensions(root_, told);
}

const Json& File::at(const char* list, size_t index) const {
    const Json& all = listIn(root_, list);
    if (index >= all.size()) fail("there is no {}[{}]; the file has {}", list, index, all.size());
    return all[index];
}

ByteSpan File::buffer(size_t index) {
    const Json& of = at("buffers", index);
    const std::optional<size_t> length = wholeIn(of, "byteLength");
    const std::string uri = textIn(of, "uri");
    ByteSpan data = binary_;
    if (!uri.empty()) {
        const auto [found, fresh] = buffers_.try_emplace(index);
        if (fresh) found->second = buffer_sources_.read(uri);
        data = found->second;
    } else if (index != 0 || binary_.empty()) {
        fail("buffers[{}] has no uri, and there is no data for it in the file", index);
    }
    if (length.value_or(0) > data.size())
        fail("buffers[{}] has {} bytes; its byteLength is {}", index, data.size(), *length);
    return data.first(length.value_or(data.size()));
}

ByteSpan File::view(size_t index) {
    const Json& of = at("bufferViews", index);
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (const Json& compressed = extension(of, name);
            !compressed.is_null() && textIn(at("buffers", wholeIn(of, "buffer").value_or(0)), "uri").empty())
            fail("bufferViews[{}] is there in extension {} alone; export it without compression", index, name);
    const std::optional<size_t> buffer_index = wholeIn(of, "buffer"), length = wholeIn(of, "byteLength");
    if (!buffer_index || !length) fail("bufferViews[{}] has no buffer or no byteLength", index);
    const ByteSpan data = buffer(*buffer_index);
    const size_t offset = wholeIn(of, "byteOffset").value_or(0);
    if (offset > data.size() || *length > data.size() - offset)
        fail("bufferViews[{}] is larger than its buffer of {} bytes", index, data.size());
    return data.subspan(offset, *length);
}

Bytes File::content(const Json& of) {
    if (const std::optional<size_t> index = wholeIn(of, "bufferView")) {
        const ByteSpan data = view(*index);
        return {data.begin(), data.end()};
    }
    const std::string uri = textIn(of, "uri");
    if (uri.empty()) fail("neither uri nor bufferView");
    return image_sources_.read(uri);
}

} // namespace brume::gltf
