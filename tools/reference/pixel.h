// One pixel of the reference: the ray through its centre, and whether an edge of an object or of its shadow crosses it.
#pragma once

#include "tools/reference/camera.h"
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

// True if some plane has a structure.
bool hasStructure(const World& world);

// True if there is something whose edges a picture may show.
inline bool hasEdges(const World& world) { return !world.obstacles.empty() || !world.sheets.empty(); }

// `at(x, y, even)`: the ray's result at this position in the pixel, each in [0, 1]; `even`: Ray::even. `objects`:
// hasEdges(). `structure`: hasStructure(). A structure varies within a pixel, but is no edge. Edges do not matter where
// the centre's transmittance is `most` or more.
template <class At>
PixelResult pixelOf(const At& at, bool objects, bool structure, double most = 2) {
    PixelResult pixel{.centre = at(0.5, 0.5, false)};
    pixel.total = pixel.centre.total(), pixel.transmittance = pixel.centre.transmittance;
    if (!objects || pixel.transmittance >= most) return pixel;
    struct Mean {
        glm::dvec3 total{0};
        double transmittance = 0;
    };
    // Of the rays at four points that far from the centre, in pixels.
    const auto meanAt = [&](double off, bool even) {
        Mean mean;
        for (const double x : {-off, off})
            for (const double y : {-off, off}) {
                const RayResult ray = at(0.5 + x, 0.5 + y, even);
                mean.total += ray.total() / 4.0, mean.transmittance += ray.transmittance / 4;
            }
        return mean;
    };
    const glm::dvec3 centre = structure ? at(0.5, 0.5, true).total() : pixel.total;
    Mean mean = meanAt(0.25, structure);
    pixel.edge = isEdge(centre, mean.total, meanAt(0.5, structure).total);
    if (!pixel.edge) return pixel;
    if (structure) mean = meanAt(0.25, false);
    pixel.total = mean.total, pixel.transmittance = mean.transmittance;
    return pixel;
}

// Pixels of a camera's picture. Each thread has its own.
class PixelTracer {
public:
    // Both must outlive it.
    PixelTracer(const Stage& stage, const Camera& camera);
    PixelResult at(glm::uvec2 pixel);

private:
    RayTracer tracer_;
    const Camera& camera_;
    bool objects_, structure_; // of the world
};

} // namespace brume::reference
