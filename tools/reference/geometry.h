// Exact intersections of rays with fog, tetrahedra and opaque objects, and with the boundaries of shadows.
#pragma once

#include <span>
#include <vector>

#include "tools/reference/world.h"

namespace brume::reference {

Interval common(Interval a, Interval b);

// The part of the whole line through the ray that lies inside; empty if there is none.
Interval insideSphere(glm::dvec3 centre, double radius, const Ray& ray);
Interval insideFog(const Fog& fog, const Ray& ray);
// `axes`: the blob's, along which its tetrahedron is stretched; null: none.
Interval insideTetrahedron(const Blob& blob, const SemiAxes* axes, const Ray& ray);

// Optical depth of the fog between ray.begin and ray.end, which may be infinite.
double depthOn(const Fog& fog, const Ray& ray);
// Distance from ray.begin at which the fog's optical depth reaches `depth`; kInfinity if that is beyond ray.end.
double distanceOfDepth(const Fog& fog, const Ray& ray, double depth);

// The parts of [ray.begin, ray.end] inside at least one ball, in order and disjoint.
void insideUnion(const UnionMedium& medium, const Ray& ray, std::vector<Interval>& parts);

struct Hit {
    double t = kInfinity;
    int object = -1; // -1: none
    glm::dvec3 normal{0, 1, 0};
};
// The first surface on [begin, end] that the ray enters from outside; a plane only from above.
Hit nearest(std::span<const Obstacle> obstacles, const Ray& ray);
// A sheet of glass on [begin, end].
struct SheetHit {
    double t;
    glm::dvec3 passes;   // part of what is behind it
    glm::dvec3 mirrored; // radiance
};
// All sheets that the ray meets, the nearest first.
void sheetsOn(const World& world, const Ray& ray, std::vector<SheetHit>& hits);
// True if an object other than `skip` lies on [begin, end].
bool occluded(std::span<const Obstacle> obstacles, const Ray& ray, int skip = -1);

// Appends every t at which the shadow of the object under this light can begin or end on the ray's line: silhouettes
// of spheres, planes through the light and the edges of a box or a triangle, the height of a plane. Some may be no
// edges; none is missing, but those where the shadow of a triangle beyond an edge goes on.
void shadowEdges(const Obstacle& object, const LightSource& light, const Ray& ray, std::vector<double>& t);
// Appends every t at which the optical depth of a tetrahedron toward the light may have a kink.
void shadowEdges(const Blob& tetrahedron, const LightSource& light, const Ray& ray, std::vector<double>& t);
// Appends every t at which the ray's line crosses the double cone about `axis` (unit) with this squared cosine of its
// half-angle.
void coneCrossings(glm::dvec3 apex, glm::dvec3 axis, double cosine_squared, const Ray& ray, std::vector<double>& t);

} // namespace brume::reference
