// LightField: the exact optical depth of Gaussian particles between any point and a light. It visits only particles
// near the line.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "tools/reference/erf_table.h"
#include "tools/reference/world.h"

namespace brume::reference {

// Radius, in units of 1/k, at which a Gaussian ends: a part e^-21 = 7e-10 of its mass is left out.
inline constexpr double kReach = 4.6;

struct ShapedBlob {
    Blob blob;
    SemiAxes axes;
};

// The depth toward a distant light.
class LightField {
public:
    // `reach`: in units of 1/k; a point's depth lacks at most e^(-reach^2) of each particle's depth. `to_light`: unit.
    // `cells`: of the light's plane, along the radius of a mean particle. `axes`: of each blob; empty: balls.
    LightField(std::span<const Blob> blobs, glm::dvec3 to_light, double reach = kReach, double cells = 8,
               std::span<const SemiAxes> axes = {});

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
    std::vector<Shade> shades_;            // nearest to the light first
    std::vector<ShapedBlob> shaped_;       // the same, if they are no balls
    std::vector<uint32_t> first_, listed_; // per cell of the light's plane: the shades that reach it, in that order
    const ErfTable& table_ = ErfTable::shared();
};

// The depth toward a light at a position: that of the finite segment which ends there.
class PointField {
public:
    PointField(std::span<const Blob> blobs, glm::dvec3 position, double reach = kReach,
               std::span<const SemiAxes> axes = {});
    double depth(glm::dvec3 x) const;

private:
    struct Shade {
        glm::dvec3 centre;
        double k, half_line, reach;
    };
    glm::dvec3 position_;
    std::vector<Shade> shades_;
    std::vector<ShapedBlob> shaped_;       // the same, if they are no balls
    std::vector<uint32_t> first_, listed_; // per cell of the octahedron of directions from the light
    const ErfTable& table_ = ErfTable::shared();
};

} // namespace brume::reference
