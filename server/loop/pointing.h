// Pointing: where the rays of people's pointers meet what is seen.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "server/sim/simulation.h"
#include "server/viewer/people.h"

namespace brume {

class Obstacles;

class Pointing {
public:
    Pointing();
    ~Pointing();

    // Another scene is shown.
    void forget();
    // Answers rays that have moved. Costs nothing where none has.
    void follow(const Scene& scene, const Simulation& simulation, People& people);

    // Where along the ray, m: on the first surface, if the medium before it hides less than half of it; otherwise at
    // the depth by which half of what the medium hides on the ray is hidden. Nothing: the ray meets no surface, and
    // less than 2 % of it is hidden. Balls, ellipsoids, voxels and corners of tetrahedra count as Gaussians as wide.
    // `particles`: of the medium; `falloff`: Medium::falloff. Exact for Gaussians within 1 cm.
    std::optional<float> depthOf(const PointingRay& ray, const Obstacles& solids,
                                 std::span<const gpu::Particle> particles, float falloff);

private:
    struct OnRay {              // a particle's Gaussian on the ray
        double centre, k, line; // m, 1/m, optical depth of the whole line
    };
    double depthUpTo(double metres) const; // optical depth

    std::unique_ptr<Obstacles> solids_; // of the scene; null until a ray comes
    std::vector<gpu::Particle> particles_;
    std::vector<OnRay> on_ray_;
};

} // namespace brume
