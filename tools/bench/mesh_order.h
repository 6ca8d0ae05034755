// What drawing tetrahedra in the order of their centres costs, in double precision: nothing errs but the order.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace brume::bench {

struct MeshOrderQuestion {
    int cells = 12;           // cubes along each side of a mesh
    int wide = 96, high = 64; // rays of a picture
};

// Rows of meshes (body-centred cubic, with corners moved at random, each as it is and stretched 4:1) and mean optical
// depths (1, 4, 16). Each is seen from four places. A tetrahedron scatters light that falls
// exponentially across the mesh. "least", "most": of the four pictures' relative RMSE beside the true order;
// "worst_pixel": the largest difference of a pixel over the brightest one.
nlohmann::json meshOrderRows(const MeshOrderQuestion& question);

} // namespace brume::bench
