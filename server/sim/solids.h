// Solids: boxes, balls and triangles, as what moves meets them. Exactly rounded operations only, so the same bits on
// every machine.
#pragma once

#include <optional>

#include <glm/glm.hpp>

#include "common/bounding_tree.h"
#include "common/scene.h"

namespace brume {

struct SolidBox {
    glm::dvec3 centre, half;
    double cosine, sine; // of its angle about the vertical
};
struct SolidBall {
    glm::dvec3 centre;
    double radius;
};

SolidBox solidOf(const Box& box);
SolidBall solidOf(const Sphere& sphere);

Bounds3 boundsOf(const SolidBox& box);
Bounds3 boundsOf(const SolidBall& ball);
Bounds3 boundsOf(const Triangle& triangle);

// Where a way that begins outside enters a solid. The normal is that of the face, toward where the way comes from.
struct Met {
    double part; // of the way, in [0, 1]
    glm::dvec3 normal;
};
std::optional<Met> meet(const SolidBox& box, glm::dvec3 from, glm::dvec3 way);
std::optional<Met> meet(const SolidBall& ball, glm::dvec3 from, glm::dvec3 way);
std::optional<Met> meet(const Triangle& triangle, glm::dvec3 from, glm::dvec3 way);

// The shortest way out, for a place in a solid: so far along the normal. Triangles have no inside.
struct Depth {
    double metres;
    glm::dvec3 normal;
};
std::optional<Depth> depthIn(const SolidBox& box, glm::dvec3 place);
std::optional<Depth> depthIn(const SolidBall& ball, glm::dvec3 place);

// From a solid's point that is nearest to a place outside, to the place. Of a place inside a box or ball it is 0.
glm::dvec3 offFrom(const SolidBox& box, glm::dvec3 place);
glm::dvec3 offFrom(const SolidBall& ball, glm::dvec3 place);
glm::dvec3 offFrom(const Triangle& triangle, glm::dvec3 place);

} // namespace brume
