#include "tools/import/nrrd_file.h"

#include <bit>
#include <cmath>
#include <fstream>

#include <fmt/format.h>

namespace brume::volumes {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr double kStraight = 1e-6;

glm::dvec3 placed(glm::dvec3 x, const Placing& placing) {
    return placing.scale * (placing.z_up ? glm::dvec3(x.x, x.z, -x.y) : x);
}

std::string text(glm::dvec3 v) { return fmt::format("({:.17g},{:.17g},{:.17g})", v.x, v.y, v.z); }

} // namespace

void writeNrrd(const std::filesystem::path& file, const Volume& volume, const Placing& placing,
               const std::string& comment) {
    const glm::ivec3 lo = volume.voxels.lo(), size = volume.voxels.hi() - lo + 1;
    // The axis of the scene that each of the voxels' axes lies along, and its order in the file: x, y, z.
    glm::ivec3 axis_of(0);
    glm::dvec3 directions[3];
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 way = placed(volume.turn[i], placing);
        const glm::dvec3 along = glm::abs(way);
        const int axis = along.x >= along.y && along.x >= along.z ? 0 : along.y >= along.z ? 1 : 2;
        for (int other = 0; other < 3; ++other)
            if (other != axis && along[other] > kStraight * along[axis])
                throw ImportError("its voxels are turned; write a .ply, which fits particles to them");
        axis_of[axis] = i;
        directions[axis] = glm::dvec3(0);
        directions[axis][axis] = way[axis];
    }
    const glm::ivec3 sizes(size[axis_of.x], size[axis_of.y], size[axis_of.z]);
    if (const double box = double(sizes.x) * sizes.y * sizes.z; box > double(kMostVoxels))
        throw ImportError(fmt::format("the box of all voxels has {:.0f}; allowed in a .nrrd: {}", box, kMostVoxels));
    const glm::dvec3 origin = placed(volume.turn * glm::dvec3(lo) + volume.origin, placing);
    std::ofstream out(file, std::ios::binary);
    out << fmt::format(
        "NRRD0005\n# {}; extinction, 1/m\ntype: float\ndimension: 3\nspace dimension: 3\nsizes: {} {} {}\n"
        "space directions: {} {} {}\nspace origin: {}\nendian: little\nencoding: raw\n\n",
        comment, sizes.x, sizes.y, sizes.z, text(directions[0]), text(directions[1]), text(directions[2]),
        text(origin));
    for (int k = 0; k < sizes.z; ++k)
        for (int j = 0; j < sizes.y; ++j)
            for (int i = 0; i < sizes.x; ++i) {
                glm::ivec3 voxel = lo;
                voxel[axis_of.x] += i, voxel[axis_of.y] += j, voxel[axis_of.z] += k;
                const float value = volume.voxels.at(voxel) * float(placing.density);
                out.write(reinterpret_cast<const char*>(&value), sizeof value);
            }
    out.flush();
    if (!out) throw ImportError(file.string() + ": cannot be written");
}

} // namespace brume::volumes
