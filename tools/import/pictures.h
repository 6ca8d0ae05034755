// Pictures of lit voxels, and how far those of a fit are from them. All in double precision.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "tools/import/voxels.h"

namespace brume::volumes {

// Sunlight that the medium scatters once, seen by parallel rays: the integral of extinction times what is left of the
// light from the sun, and of that on its way to the viewer. Scattering is even in all directions, and nothing is
// absorbed; both are factors, as the sun's light is.
class Pictures {
public:
    // From `count` sides, each with a sun of its own, `side` x `side` pixels. `per_value`: optical depth of a voxel of
    // value 1. `voxels` must outlive it. Precondition: some voxel is above 0.
    Pictures(const Voxels& voxels, double per_value, int side = 36, int count = 4, uint64_t seed = 2);

    // Relative RMSE over all pixels. `values`: those of a fit, beside voxels.values().
    double errorOf(std::span<const float> values) const;

private:
    struct View {
        glm::dvec3 toward, u, v, sun; // unit length; u and v across
        std::vector<double> light;    // v slower than u
    };
    double lightOf(const View& view, int pixel, std::span<const float> values) const;
    // Calls visit(view, pixel) for all, by all cores.
    template <class Visit>
    void forPixels(const Visit& visit) const;

    const Voxels& voxels_;
    double per_value_;
    int side_;
    std::vector<View> views_;
};

} // namespace brume::volumes
