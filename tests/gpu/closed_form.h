// Exact results for one Gaussian particle on one ray, in double precision. Tests compare pictures of single particles
// with them.
#pragma once

#include <functional>
#include <vector>

#include <glm/glm.hpp>

#include "common/camera.h"
#include "tests/gpu/fixture.h"
#include "tools/reference/light_field.h"

namespace brume::test {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kNearDepth = 0.05; // m, the renderer's near plane

// Directions from a particle's centre to the vertices of its tetrahedron; the number of vertices behind a pose's near
// plane.
extern const glm::vec3 kVertices[4];
int verticesBehind(const Point& p, const Pose& pose);

// A particle whose central optical depth is `depth`.
Point thick(glm::vec3 centre, float scale, double depth, float falloff);

// Tolerance of a transmittance, for a particle of central optical depth `depth` at `distance` (m): float rounding,
// and the cut-off of 1e-6. A position errs by about an ulp of the distance. Through k^2 b^2, that changes the optical
// depth by up to 0.86 k tau per metre.
double allowed(double distance, double k, double depth);

// Steps, in pixels, of the places to which the device rounds the vertices of what it draws: 1/256 on lavapipe, at most
// 1/16.
double subpixel(const gpu::Device& device);

// The scene's particles, as the renderer gets them and as the reference does.
std::vector<gpu::Particle> particlesOf(const Scene& scene);
std::vector<reference::Blob> blobsOf(const Scene& scene);

// A ray. Distances along it are in metres from the eye; `begin` is on the near plane.
struct Ray {
    glm::dvec3 eye, w;
    double begin;
    glm::dvec3 at(double t) const { return eye + t * w; }
};
Ray rayThrough(const Pose& pose, uint32_t width, uint32_t height, uint32_t x, uint32_t y);

struct Interval {
    double begin, end;
    double length() const { return end > begin ? end - begin : 0; }
};
// The interval of a ray, from its begin on, inside the particle's tetrahedron; and the whole ray from its begin on.
Interval insideTetrahedron(const reference::Blob& blob, const Ray& ray);
Interval wholeRay(const Ray& ray);
// The interval that a pixel looks up if the particle's proxy is drawn `off` (pixels) away: a ray has the view depths
// of its neighbour that far away.
Interval insideTetrahedronDrawn(const reference::Blob& blob, const Pose& pose, uint32_t width, uint32_t height,
                                uint32_t x, uint32_t y, glm::dvec2 off);

// Optical depth on the interval; 0 if it is empty.
double depthOn(const reference::Blob& blob, const Ray& ray, Interval interval);

// Integral of sigma T_V e^(-light_depth(t)) over the interval, T_V from its begin; relative error below 1e-7.
double scatteredOn(const reference::Blob& blob, const Ray& ray, Interval interval,
                   const std::function<double(double)>& light_depth);

// The quadratures by their definitions, with the light's optical depth from `light_depth(t)`. Simpson's is limited to
// 1 - T, as in method isv.
double simpson(const reference::Blob& blob, const Ray& ray, Interval interval, int steps,
               const std::function<double(double)>& light_depth);
double transmittanceSpace(const reference::Blob& blob, const Ray& ray, Interval interval, int points,
                          const std::function<double(double)>& light_depth);
// Two points at mean -+ standard deviation of the Gaussian on the interval. Their weights are those of an uncut
// Gaussian of the same optical depth.
double twoPoints(const reference::Blob& blob, const Ray& ray, Interval interval,
                 const std::function<double(double)>& light_depth);

} // namespace brume::test
