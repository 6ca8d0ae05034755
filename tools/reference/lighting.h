// Lighting: light that arrives at a point from a world's lights, through the medium and past opaque objects.
#pragma once

#include <optional>
#include <vector>

#include "tools/reference/light_field.h"
#include "tools/reference/obstacle_tree.h"
#include "tools/reference/tetrahedra.h"
#include "tools/reference/voxels.h"
#include "tools/reference/world.h"

namespace brume::reference {

// Light that arrives at a point with nothing in between.
struct Arrival {
    glm::dvec3 irradiance; // perpendicular, W/m^2
    glm::dvec3 to_light;   // unit
    double distance;       // m
};
Arrival arrivalAt(const LightSource& light, glm::dvec3 x);

class Lighting {
public:
    // `world` must outlive it. `reach` as in LightField. shadows = false: every light reaches every point unattenuated.
    // `cells`: Settings::light_cells.
    Lighting(const World& world, double reach, bool shadows, double cells = 8);

    // Of each phase function the sum over lights of E p T_L Vis: radiance scattered at x toward -w per unit of
    // scattering, where w is the ray's direction. `sums` is as long as `phases`.
    void scattered(glm::dvec3 x, glm::dvec3 w, std::span<const PhaseLobes> phases, std::span<glm::dvec3> sums) const;
    // Radiance that the ray's surface reflects, by Lambert's law: of the lights, past objects and medium, and of the
    // whole sky above the horizon (shaders/shared/sky.h).
    glm::dvec3 surface(const Hit& hit, const Ray& ray) const;

    // Optical depth from x to light `i`; kInfinity if an object other than `skip` is in between.
    double depth(size_t i, glm::dvec3 x, const Arrival& arrival, int skip = -1) const;
    // Every t on the ray at which the light may have a kink or a jump, or is nearest.
    void edges(const Ray& ray, std::vector<double>& t) const;

    const ObstacleTree& obstacles() const { return obstacles_; }
    const TetrahedraTree& tetrahedra() const { return tetrahedra_; }
    const VoxelPath& voxels() const { return voxels_; }

private:
    double cutDepth(const Ray& toward) const; // optical depth of blobs that their tetrahedra cut

    struct Fields {
        std::optional<LightField> distant;
        std::optional<PointField> near;
    };
    const World& world_;
    ObstacleTree obstacles_;
    TetrahedraTree tetrahedra_;
    VoxelPath voxels_;
    bool shadows_;
    std::vector<Fields> fields_; // per light
    const ErfTable& table_ = ErfTable::shared();
};

} // namespace brume::reference
