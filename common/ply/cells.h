// Element `tetrahedron` of a PLY file: four vertices each, and maybe an extinction of its own.
#pragma once

#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "common/ply/reader.h"

namespace brume::ply {

struct Cells {
    std::vector<glm::uvec4> corners;  // indices of vertices
    std::vector<double> extinction;   // 1/m, property `s` or `sigma_t`; empty, or as long as `corners`
    std::string extinction_name;      // which of them
    std::vector<std::string> ignored; // names of properties that are not read
};

struct CellsWanted {
    uint64_t points = 0;     // how many vertices there are
    double unit = 1;         // m, of the file's lengths
    bool extinction = false; // True: that of the cells, if they have one
};

// The file stands at the first row of the element. Throws SceneError for rows that cannot be read, for vertices that
// are not there, and for extinctions out of range.
Cells readCells(Reader& in, const Element& tetrahedron, CellsWanted wanted);

} // namespace brume::ply
