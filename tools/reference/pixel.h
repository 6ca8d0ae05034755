// One pixel of the reference: the ray through its centre, and whether an edge of an object or of its shadow crosses it.
#pragma once

#include "tools/reference/ray_tracer.h"

namespace brume::reference {

struct PixelResult {
    RayResult centre;
    bool edge = false; // True: an edge crosses the pixel
    // Of the centre; of an edge the mean of 2x2 rays, which smooths it.
    glm::dvec3 total{0};
    double transmittance = 1;
};

// True if an edge crosses the pixel: the mean of 2x2 rays, or that of rays at its corners, is not the value at its
// centre. Corners meet edges that pass between the others. What is curved, but has no edge, differs there four times as
// much, which is allowed for.
bool isEdge(glm::vec3 centre, glm::vec3 mean, glm::vec3 corners);

// `at(x, y)`: the ray's result at this position in the pixel, each in [0, 1]. `objects`: true if the world has any;
// without them nothing has edges. Edges do not matter where the centre's transmittance is `most` or more.
template <class At>
PixelResult pixelOf(const At& at, bool objects, double most = 2) {
    PixelResult pixel{.centre = at(0.5, 0.5)};
    pixel.total = pixel.centre.total(), pixel.transmittance = pixel.centre.transmittance;
    if (!objects || pixel.transmittance >= most) return pixel;
    struct Mean {
        glm::dvec3 total{0};
        double transmittance = 0;
    };
    const auto meanAt = [&](double off) { // of the rays at four points that far from the centre, in pixels
        Mean mean;
        for (const double x : {-off, off})
            for (const double y : {-off, off}) {
                const RayResult ray = at(0.5 + x, 0.5 + y);
                mean.total += ray.total() / 4.0, mean.transmittance += ray.transmittance / 4;
            }
        return mean;
    };
    const Mean mean = meanAt(0.25), corners = meanAt(0.5);
    pixel.edge = isEdge(pixel.total, mean.total, corners.total);
    if (pixel.edge) pixel.total = mean.total, pixel.transmittance = mean.transmittance;
    return pixel;
}

} // namespace brume::reference
