// File: the JSON of a glTF file and the buffers that it names.
#pragma once

#include <map>
#include <span>

#include "common/gltf/bytes.h"
#include "common/gltf/json.h"
#include "common/gltf/told.h"

namespace brume::gltf {

using ByteSpan = std::span<const unsigned char>;

class File {
public:
    // `bytes` of a .glb or a .gltf file stay until the end. Throws Wrong for another version of glTF, and for one that
    // requires extensions that are not read.
    File(std::string_view bytes, const std::filesystem::path& folder);

    const Json& root() const { return root_; }
    // An element of a list at the top: at("nodes", 2).
    const Json& at(const char* list, size_t index) const;
    // Bytes of a buffer view. Buffers are read when they are asked for, so that those of animations never are.
    ByteSpan view(size_t index);
    // What an element with a `uri` or a `bufferView` holds: an image.
    Bytes content(const Json& of);

    Told told;

private:
    ByteSpan buffer(size_t index);

    Json root_;
    ByteSpan binary_; // the second chunk of a .glb; of a .gltf empty
    Sources buffer_sources_, image_sources_;
    std::map<size_t, Bytes> buffers_;
};

} // namespace brume::gltf
