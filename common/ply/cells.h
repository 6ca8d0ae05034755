// Element `tetrahedron` of a PLY file: four vertices each, and maybe an extinction of its own.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "common/ply/reader.h"

namespace brume::ply {

struct Cells {
    std::vector<glm::uvec4> corners; // indices of vertices
    std::vector<double> extinction;  // property `s` or `sigma_t`; empty, or as long as `corners`
};

// The file stands at the first row of the element. `points`: how many vertices there are. Throws SceneError for rows
// that cannot be read, and for vertices that are not there.
Cells readCells(Reader& in, const Element& tetrahedron, uint64_t points);

} // namespace brume::ply
