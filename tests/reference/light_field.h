// The exact optical depth of Gaussian particles between any point and a light, over those particles alone that matter
// there.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "tests/reference/erf_table.h"
#include "tests/reference/world.h"

namespace brume::reference {

// Beyond this many units of 1/k a Gaussian counts as nothing: a part e^-21 = 7e-10 of its mass is left out.
inline constexpr double kReach = 4.6;

// Toward a distant light.
class LightField {
public:
    // `reach` in units of 1/k; a point's depth lacks at most e^(-reach^2) of each particle's. to_light is unit.
    LightField(std::span<const Blob> blobs, glm::dvec3 to_light, double reach = kReach);

    // tau_L(x) = sum of sigma sqrt(pi)/(2k) e^(-k^2 b^2) erfc(k s).
    double depth(glm::dvec3 x) const;

private:
    struct Shade {
        double x, y, s; // light space
        double k, half_line, reach;
    };
    glm::dvec3 x_axis_, y_axis_, to_light_;
    double lo_x_ = 0, lo_y_ = 0, cell_ = 1; // m
    int cells_x_ = 0, cells_y_ = 0;
    std::vector<Shade> shades_;            // those nearest to the light first
    std::vector<uint32_t> first_, listed_; // per cell of the light's plane: which shades reach it, in that order
    ErfTable table_;
};

// Toward a light at a place: of the finite segment that ends there.
class PointField {
public:
    PointField(std::span<const Blob> blobs, glm::dvec3 position, double reach = kReach);
    double depth(glm::dvec3 x) const;

private:
    struct Shade {
        glm::dvec3 centre;
        double k, half_line, reach;
    };
    glm::dvec3 position_;
    std::vector<Shade> shades_;
    std::vector<uint32_t> first_, listed_; // per cell of the octahedron of directions from the light
    ErfTable table_;
};

} // namespace brume::reference
