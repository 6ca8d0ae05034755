// The reference renderer: single scattering in double precision on the CPU, which the renderer's pictures are
// compared with. It shares no closed form with the shaders.
#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "common/camera.h"
#include "common/scene.h"
#include "shaders/shared/types.h"
#include "tools/reference/camera.h"
#include "tools/reference/ray_tracer.h"
#include "tools/reference/world.h"

namespace brume::reference {

// Row by row from the top left, one ray through each pixel's centre.
struct Picture {
    int width = 0, height = 0;
    std::vector<glm::dvec3> radiance;   // scattered toward the camera, premultiplied (nothing behind the medium)
    std::vector<double> transmittance;  // of the medium in front of the background
    std::vector<glm::dvec3> background; // opaque surfaces and the sky, without medium

    std::vector<glm::dvec3> total() const; // radiance + transmittance * background
};

Picture render(const World& world, const Camera& camera, const Settings& settings = {});
RayResult along(const World& world, const Ray& ray, const Settings& settings = {});

// A world of particles and one distant light only: black background, no ambient light.
struct Medium {
    std::span<const gpu::Particle> particles;
    double falloff = 1.6;
    double anisotropy = 0, asymmetry = 0;
};

enum class Model {
    overlapping,            // the true medium: extinctions of uncut Gaussians add up
    sequential,             // particles integrated one by one, composited by distance of their centres
    sequential_tetrahedron, // sequential, view intervals cut by tetrahedra; light depth of uncut Gaussians
};

World worldOf(const Medium& medium, const Light& light, Model model);
Picture render(const Medium& medium, const Light& light, const Pose& pose, int width, int height, Model model,
               const Settings& settings = {});

// Relative RMSE: sqrt(sum of (value - reference)^2 / sum of reference^2) over pixels and channels where the reference
// exceeds 1e-3 of its maximum.
double relativeRmse(std::span<const glm::dvec3> value, std::span<const glm::dvec3> reference);

} // namespace brume::reference
