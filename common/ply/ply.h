// Point clouds from PLY files of many programs: ASCII and binary, of either byte order, version 1.0.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "shaders/shared/types.h"

namespace brume {

struct Medium;

// The optional lists are empty, or as long as `position`. At most one of scale, radius and deviation is there, and at
// most one of sigma_t and opacity.
struct PointCloud {
    std::vector<glm::vec3> position; // m
    std::vector<float> scale;        // m, centre to vertex of a particle's tetrahedron
    std::vector<float> radius;       // m, of a ball that spreads as far as the particle
    std::vector<float> deviation;    // m, the particle's standard deviation
    std::vector<float> sigma_t;      // 1/m, extinction at a particle's centre
    bool of_cells = false;           // True: sigma_t is the mean of what the file's tetrahedra have
    std::vector<float> opacity;      // 0 ... 1, part of the light that a particle stops on a ray through its centre
    std::vector<glm::vec3> albedo;   // linear, in [0, 1]
    std::vector<glm::vec3> velocity; // m/s; empty unless loadPly() is asked for it
    // Semi-axes over the size, which is that of the longest; empty unless loadPly() is asked for them.
    std::vector<gpu::EllipsoidAxes> axes;
    std::vector<int64_t> id;            // each point's property `id`; empty unless loadPly() is asked for it
    std::vector<glm::uvec4> tetrahedra; // indices of points; empty unless loadPly() is asked for them
    std::vector<std::string> ignored;   // names of the points' properties that are not read
    std::vector<std::string> notes;     // one line each: what else was passed over, or guessed
    // Points left out: a number of theirs is not finite or out of range, or no tetrahedron has them.
    size_t dropped = 0;
    std::string first_dropped; // why the first of them was left out: "line 9: x is nan; allowed: ..."
    // The file's number of each point, from 0; empty unless points were left out that no tetrahedron has.
    std::vector<uint32_t> vertex;
};

// How a file's places become the scene's: turned, times the unit, less the origin.
struct PlyFrame {
    glm::dvec3 origin{0}; // m
    double unit = 1;      // m, of the file's lengths; extinctions are per unit
    std::string up = "y"; // the axis of the file that points up: x, y, z or -y

    bool operator==(const PlyFrame&) const = default;
};

// That of the medium's files in a scene of that origin.
PlyFrame frameOf(const Medium& medium, glm::dvec3 origin);

// What is read besides places, sizes, extinctions and albedos.
struct PlyWanted {
    bool ids = false; // True: the points' property id, too, if it is of a whole-number type
    // True: element `tetrahedron` with a list of four indices, vertex_indices, vertex_index or indices. Then sizes are
    // not read, and every point has to have a sigma_t, or every tetrahedron, and numbers within range. Points that no
    // tetrahedron has are left out, and the indices count the others.
    bool tetrahedra = false;
    bool axes = false;         // True: the points' semi-axes, which every file then has to have
    bool velocities = false;   // True: the points' vx vy vz, too, if all three are there
    bool may_be_empty = false; // True: a file without points is an empty cloud, not an error
    bool drop_far = false;     // True: points that PlyExtent counts as far are left out
    uint64_t most = 1'000'000; // points
};

inline constexpr uint64_t kMostPlyPoints = 8'000'000; // that are read at all
inline constexpr uint64_t kMostPlyBytes = 512ull << 20;

// Reads element `vertex` with x y z and, if present, scale or radius, sigma_t or opacity, and red green blue; or splats
// of 3D Gaussian splatting, packed or not. If asked, semi-axes axis_a_x ... axis_c_z, or the splats' own. Everything
// else is passed over. Colours and opacities are parts of 1, or
// whole numbers up to 255 or 65535 that stand for 1. Positions are read as doubles, and become floats in the frame.
// Points that then lie beyond limits::kPlace are dropped. Throws SceneError for a file that cannot be read, is not
// such a PLY, ends early, has no usable point, or lacks what is wanted of tetrahedra.
PointCloud loadPly(const std::filesystem::path& file, const PlyFrame& frame = {}, PlyWanted wanted = {});

// The bytes of a file, as parsePly() takes them. Throws SceneError if it cannot be read or has more than kMostPlyBytes.
std::string plyBytes(const std::filesystem::path& file);

// Reads the bytes of a PLY file from memory; messages call the file `name`.
PointCloud parsePly(std::string_view bytes, const std::string& name, const PlyFrame& frame = {}, PlyWanted wanted = {});

// Where a file's points are, turned as in PlyFrame, in the file's unit.
struct PlyExtent {
    glm::dvec3 middle{0}; // median along each axis
    double radius = 0;    // along the axes; 98 % of the points are within it, or of 8 and more all but one
    size_t count = 0;     // of points at finite places
    size_t far = 0;       // points more than 20 radii away, if they are at most 2 %, or one of 8 or more
    double farthest = 0;  // how far the farthest of these is from the middle
};
PlyExtent extentOf(std::string_view bytes, const std::string& name, const std::string& up);
PlyExtent extentOf(const std::filesystem::path& file, const std::string& up);
// The origin, m, of a scene of such points: where they are, in whole metres, if they are beyond a kilometre and beyond
// two radii. Throws SceneError beyond limits::kOrigin.
glm::dvec3 originFor(const PlyExtent& extent, double unit);

// True: the file has rows of element `vertex`. Throws SceneError for a file that cannot be read, and for such a header.
bool holdsPoints(const std::filesystem::path& file);
// What kinds of media a file can be shown as.
struct PlyContents {
    bool splats = false;     // True: its points are of Gaussian splatting, packed or not
    bool axes = false;       // True: they have axes of their own
    bool tetrahedra = false; // True: it has rows of element `tetrahedron`
};
// Throws SceneError for a header that parsePly() would refuse.
PlyContents contentsOf(std::string_view bytes, const std::string& name);
// True: some point's axes differ by more than a hundredth. Throws SceneError for a file that parsePly() would refuse.
// Precondition: its points have axes.
bool hasEllipsoids(std::string_view bytes, const std::string& name);

} // namespace brume
