// VoxelPath: the exact way of a ray through a volume. Extinction is trilinear between the middles of voxels, so it is
// a cubic of the distance within each cell between eight of them.
#pragma once

#include <vector>

#include "tools/reference/tetrahedra.h"
#include "tools/reference/world.h"

namespace brume::reference {

class VoxelPath {
public:
    // `medium` must outlive it.
    explicit VoxelPath(const VoxelMedium& medium) : medium_(medium) {}

    // Appends the parts of [ray.begin, ray.end] in cells that hold something, by their begin.
    void along(const Ray& ray, std::vector<CellPart>& parts) const;
    // Optical depth between ray.begin and ray.end.
    double depth(const Ray& ray) const;

private:
    // Calls act(begin, end) for each cell on the ray that holds something, in order.
    template <class Act>
    void eachCell(const Ray& ray, const Act& act) const;
    double at(glm::dvec3 x, glm::ivec3 cell) const; // 1/m; x in voxels, in that cell

    const VoxelMedium& medium_;
};

} // namespace brume::reference
