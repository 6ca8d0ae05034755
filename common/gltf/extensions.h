// What the reader does with extensions of glTF.
#pragma once

#include "common/gltf/json.h"
#include "common/gltf/told.h"

namespace brume::gltf {

// Throws Wrong for one that the file requires, unless triangles are all there without it. Tells which ones are ignored.
void checkExtensions(const Json& root, Told& told);

} // namespace brume::gltf
