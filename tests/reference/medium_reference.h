// A medium of Gaussian particles under one directional light, single scattering, in double precision on the CPU: what the
// renderer's pictures are measured against. Shares no closed form with the shaders.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "common/camera.h"
#include "common/scene.h"
#include "shaders/shared/types.h"

namespace brume::reference {

struct Medium {
    std::span<const gpu::Particle> particles;
    double falloff = 1.6;
    double anisotropy = 0, asymmetry = 0;
};

enum class Model {
    overlapping,            // the true medium: extinctions add up, everywhere the whole Gaussian
    sequential,             // particles integrated one by one and composited by the distance of their centres from the camera
    sequential_tetrahedron, // the same, each particle's view interval cut by its tetrahedron (light depth: whole Gaussians still)
};

struct Settings {
    bool shadows = true;   // false: the light reaches every point unattenuated
    double refinement = 1; // 2 halves the panels that rays start from and asks a hundredth of their error
    unsigned threads = 0;  // 0: as many as the machine has
};

// Row by row from the top left, pixel centres at +0.5.
struct Picture {
    int width = 0, height = 0;
    std::vector<glm::dvec3> radiance;  // scattered toward the camera, premultiplied (nothing behind the medium)
    std::vector<double> transmittance; // of what is behind it
};

// Rays start at the camera itself; there are no opaque objects and no ambient light. Panels of 8 Gauss-Legendre nodes are halved
// until their highest Legendre coefficients are below 1e-2 of the panel; the tests show that refining changes less than 1e-5.
Picture render(const Medium& medium, const Light& light, const Pose& pose, int width, int height, Model model,
               const Settings& settings = {});

// Relative RMSE: sqrt(sum of (value - reference)^2 / sum of reference^2) over pixels and channels where the reference exceeds
// 1e-3 of its maximum.
double relativeRmse(std::span<const glm::dvec3> value, std::span<const glm::dvec3> reference);

} // namespace brume::reference
