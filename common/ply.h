// Point clouds from PLY files: ASCII and binary little-endian, version 1.0.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

namespace brume {

// The optional lists are empty, or as long as `position`. At most one of scale and radius is there, and at most one of
// sigma_t and opacity.
struct PointCloud {
    std::vector<glm::vec3> position;    // m
    std::vector<float> scale;           // m, centre to vertex of a particle's tetrahedron
    std::vector<float> radius;          // m, of a ball that spreads as far as the particle
    std::vector<float> sigma_t;         // 1/m, extinction at a particle's centre
    std::vector<float> opacity;         // 0 ... 1, part of the light that a particle stops on a ray through its centre
    std::vector<glm::vec3> albedo;      // linear, in [0, 1]
    std::vector<int64_t> id;            // each point's property `id`; empty unless loadPly() is asked for it
    std::vector<glm::uvec4> tetrahedra; // indices of points; empty unless loadPly() is asked for them
    std::vector<std::string> ignored;   // names of the points' properties that are not read
    // Points left out: a number of theirs is not finite or out of range, or no tetrahedron has them.
    size_t dropped = 0;
    std::string first_dropped; // why the first of them was left out: "line 9: x is nan; allowed: ..."
    // The file's number of each point, from 0; empty unless points were left out that no tetrahedron has.
    std::vector<uint32_t> vertex;
};

// What is read besides places, sizes, extinctions and albedos.
struct PlyWanted {
    bool ids = false; // True: the points' property id, too, if it is of a whole-number type
    // True: element `tetrahedron` with a list of four indices, vertex_indices or vertex_index. Then sizes are not read,
    // and every point has to have a sigma_t and numbers within range. Points that no tetrahedron has are left out, and
    // the indices count the others.
    bool tetrahedra = false;
};

// Reads element `vertex` with x y z and, if present, scale or radius, sigma_t or opacity, red green blue or
// diffuse_red diffuse_green diffuse_blue; everything else is skipped. Of a uchar, 255 stands for 1.
// Positions are read as doubles, and `origin` (m) is subtracted before they become floats. Points that then lie
// beyond limits::kPlace are dropped. Throws SceneError for a file that cannot be read, is not such a PLY, ends early,
// has no usable point, or lacks what is wanted of tetrahedra.
PointCloud loadPly(const std::filesystem::path& file, glm::dvec3 origin = glm::dvec3(0), PlyWanted wanted = {});

// Reads the bytes of a PLY file from memory; messages call the file `name`.
PointCloud parsePly(std::string_view bytes, const std::string& name, glm::dvec3 origin = glm::dvec3(0),
                    PlyWanted wanted = {});

// True: the file has rows of element `tetrahedron`. Throws SceneError for a header that parsePly() would refuse.
bool holdsTetrahedra(std::string_view bytes, const std::string& name);

} // namespace brume
