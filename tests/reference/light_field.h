// The medium as the double-precision reference sees it, and the exact optical depth from any point to the light.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "shaders/shared/types.h"

namespace brume::reference {

// Beyond this many units of 1/k a Gaussian counts as nothing: a part erfc(4.6) = 8e-11 of each line's optical depth is left out.
inline constexpr double kReach = 4.6;

struct Blob {
    glm::dvec3 centre; // m
    double scale;      // m, centre to vertex of its tetrahedron
    double k;          // 1/m: extinction = sigma_t exp(-k^2 r^2)
    double sigma_t;    // 1/m at the centre
    double half_line;  // optical depth from the centre outward
    glm::dvec3 albedo;
};

std::vector<Blob> blobsOf(std::span<const gpu::Particle> particles, double falloff);

class LightField {
public:
    // `blobs` must outlive the field; to_light is unit.
    LightField(std::span<const Blob> blobs, glm::dvec3 to_light);

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
};

} // namespace brume::reference
