// The points of a PLY file as plain numbers, whatever program wrote them: element `vertex` of a point cloud or of
// Gaussian splatting, or its packed form.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/ply/reader.h"

namespace brume::ply {

// What is taken of a point.
enum Slot : size_t {
    kX,
    kY,
    kZ,
    kScale,
    kRadius,
    kDeviation, // a Gaussian's standard deviation
    kSigmaT,
    kOpacity,
    kRed,
    kGreen,
    kBlue,
    kId,
    kVX, // velocity, the file's unit a second
    kVY,
    kVZ,
    kAxisAX, // three semi-axes, in the file's unit or over the size, each x, y, z
    kAxisCZ = kAxisAX + 8,
    kSlots
};

// In the file's own unit and axes. Opacities and colours are parts of 1, if the file is as it should be.
struct Points {
    std::array<std::vector<double>, kSlots> columns; // each empty, or as long as the others
    std::array<double, kSlots> whole;                // what the file has for 1, of colours and opacities
    std::vector<uint32_t> rows;                      // Reader::rowNumber() of each
    std::vector<std::string> ignored;                // names of properties that are not read
    std::vector<std::string> notes;                  // one line each: what was guessed

    Points() { whole.fill(1); }
    bool has(Slot slot) const { return !columns[slot].empty(); }
    size_t count() const { return columns[kX].size(); }
};

struct PointsWanted {
    bool ids = false;        // True: property `id`, too, if it is of a whole-number type
    bool corners = false;    // True: points are corners of tetrahedra, which have no sizes
    bool axes = false;       // True: the points' semi-axes, too
    bool velocities = false; // True: their velocities, too, if all three numbers are there
};

// The file stands at the first row of `vertex`. Sizes are `scale` or `radius`, extinctions `sigma_t` or `opacity`,
// colours `red green blue`, `diffuse_red ...` or `r g b`. Throws SceneError for rows that cannot be read, and where a
// property is there twice, or is a list.
Points readPoints(Reader& in, const Element& vertex, PointsWanted wanted);

// True: element `vertex` holds splats of Kerbl et al. 2023 (3D Gaussian splatting), whose sizes are logarithms and
// whose opacities are logits.
bool holdsSplats(const Element& vertex);
// Those as points. A splat becomes a ball of the same volume.
Points readSplats(Reader& in, const Element& vertex, bool axes = false);

// True: the elements `chunk` and `vertex` hold splats in the packed form of SuperSplat.
bool holdsPackedSplats(const Header& header);
// Those as points. The file stands at the first row of its first element.
Points readPackedSplats(Reader& in, const Header& header, bool axes = false);

} // namespace brume::ply
