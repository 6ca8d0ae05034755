// Drawing tetrahedra in the order of their centres.
#include "tools/bench/mesh_order.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace brume::bench {
namespace mesh_order_test {

// A tetrahedron of the body-centred cubic lattice has its centre in the middle of its circumsphere, and all spheres are
// alike: then the nearer centre is never behind (Edelsbrunner 1990). Of a stretched mesh that is no longer so.
TEST(MeshOrder, IsExactWhereCentresAreThoseOfEqualCircumspheres) {
    double regular = 0, stretched = 0;
    for (const nlohmann::json& row : meshOrderRows({.cells = 5, .wide = 24, .high = 16})) {
        if (row.at("variant") == "body-centred cubic") regular = std::max(regular, row.at("most").get<double>());
        if (row.at("variant") == "the same, stretched 4:1")
            stretched = std::max(stretched, row.at("most").get<double>());
    }
    EXPECT_LT(regular, 1e-12);
    EXPECT_GT(stretched, 0.01);
}

} // namespace mesh_order_test
} // namespace brume::bench
