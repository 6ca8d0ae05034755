// The points of a fit in metres, and their PLY file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include <glm/glm.hpp>

#include "tools/import/fit.h"
#include "tools/import/volume.h"

namespace brume::volumes {

// How a file's space becomes that of a scene.
struct Placing {
    bool z_up = false;    // True: (x, y, z) becomes (x, z, -y)
    double scale = 1;     // m per unit of the file
    double density = 1;   // extinction (1/m) of a value of 1
    double falloff = 1.6; // of the scene: sizes follow from it
};

// Optical depth of a voxel of value 1.
double depthPerValue(const Volume& volume, const Placing& placing);

// Whole numbers for cells, the same for one cell in all frames of a sequence.
class CellIds {
public:
    // `volume`: the frame's. Where its voxels lie elsewhere than the last frame's, all cells get new numbers.
    void begin(const Volume& volume);
    int32_t of(const Kernel& kernel);

private:
    std::map<std::tuple<int, int, int, int>, int32_t> ids_;
    int32_t next_ = 0;
    glm::dmat3 turn_{0};
    glm::dvec3 origin_{0};
};

struct Cloud {
    struct Point {
        glm::vec3 at; // m
        float scale, sigma_t;
        glm::vec3 albedo{1};
        glm::vec3 velocity{0}; // m/s
        int32_t id = 0;
        glm::mat3 axes{1}; // columns at right angles, the longest of length 1
    };
    std::vector<Point> points;
    bool coloured = false, has_ids = false, has_velocities = false, has_axes = false; // what their file says of them
};

// `ids`: of a sequence, otherwise null. Points of a sequence have a velocity, where the volume has, or else an id.
// Throws ImportError for points that a scene cannot have.
Cloud cloudOf(const Volume& volume, const std::vector<Kernel>& kernels, const Placing& placing, CellIds* ids);

// Binary little-endian. Throws ImportError if it cannot be written.
void writeCloud(const std::filesystem::path& file, const Cloud& cloud, const std::vector<std::string>& comments);

} // namespace brume::volumes
