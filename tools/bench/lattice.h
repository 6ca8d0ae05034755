// Tetrahedra in place of particles: their extinction at the corners of a body-centred cubic lattice.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "shaders/shared/types.h"

namespace brume::bench {

struct Lattice {
    double cell = 0; // m, edge of a cube of the lattice
    std::vector<glm::dvec3> position;
    std::vector<float> sigma_t;      // 1/m, 0 outside
    std::vector<glm::vec3> albedo;   // empty: all particles have the same
    std::vector<glm::uvec4> corners; // of each tetrahedron: indices of points
};

// `cells`: cubes along the longest side of the particles' bounds. A tetrahedron has the middles of two cubes side by
// side, and two corners of their common face. Those are left out whose corners all have less than a thousandth of the
// largest extinction. Throws std::runtime_error, one line, without extinction and for more than limits::kTetrahedra
// tetrahedra or limits::kCount points.
Lattice latticeOf(std::span<const gpu::Particle> particles, float falloff, uint32_t cells);

// A binary PLY file. `origin`: m, where the positions count from.
std::string plyOf(const Lattice& lattice, glm::dvec3 origin);

} // namespace brume::bench
