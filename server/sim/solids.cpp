#include "server/sim/solids.h"

#include <algorithm>
#include <cmath>

#include "common/elementary.h"

namespace brume {
namespace {

constexpr double kBehind = 1e-9;    // m: so far behind a face its particles are taken to be before it
constexpr double kEdge = 1e-7;      // of a triangle's sides, which overlap by so much: nothing passes between two
constexpr double kParallel = 1e-12; // of a way's cosine, below which it passes a triangle

glm::dvec3 turnedBy(double cosine, double sine, glm::dvec3 v) {
    return {cosine * v.x + sine * v.z, v.y, -sine * v.x + cosine * v.z};
}
glm::dvec3 intoBox(const SolidBox& box, glm::dvec3 v) { return turnedBy(box.cosine, -box.sine, v); }
glm::dvec3 outOfBox(const SolidBox& box, glm::dvec3 v) { return turnedBy(box.cosine, box.sine, v); }

} // namespace

SolidBox solidOf(const Box& box) {
    return {box.centre, 0.5 * glm::dvec3(box.size), cosine(double(box.yaw)), sine(double(box.yaw))};
}
SolidBall solidOf(const Sphere& sphere) { return {sphere.centre, double(sphere.radius)}; }

Bounds3 boundsOf(const SolidBall& ball) { return {ball.centre - ball.radius, ball.centre + ball.radius}; }

Bounds3 boundsOf(const SolidBox& box) {
    const double c = std::abs(box.cosine), s = std::abs(box.sine);
    const glm::dvec3 half(c * box.half.x + s * box.half.z, box.half.y, s * box.half.x + c * box.half.z);
    return {box.centre - half, box.centre + half};
}

Bounds3 boundsOf(const Triangle& triangle) {
    Bounds3 bounds;
    for (const glm::vec3& corner : triangle.corners) bounds.add({glm::dvec3(corner), glm::dvec3(corner)});
    return bounds;
}

std::optional<Met> meet(const SolidBall& ball, glm::dvec3 from, glm::dvec3 way) {
    const glm::dvec3 off = from - ball.centre;
    const double a = glm::dot(way, way), b = glm::dot(off, way), c = glm::dot(off, off) - ball.radius * ball.radius;
    const double root = b * b - a * c;
    if (!(b < 0) || !(root > 0)) return {};
    const double part = std::max((-b - std::sqrt(root)) / a, 0.0);
    if (part > 1) return {};
    return Met{part, glm::normalize(off + part * way)};
}

std::optional<Met> meet(const SolidBox& box, glm::dvec3 from, glm::dvec3 way) {
    const glm::dvec3 at = intoBox(box, from - box.centre), along = intoBox(box, way);
    double enter = -1, leave = 1;
    int face = -1;
    for (int axis = 0; axis < 3; ++axis) {
        if (along[axis] == 0) {
            if (std::abs(at[axis]) >= box.half[axis]) return {};
            continue;
        }
        const double sign = along[axis] > 0 ? 1 : -1;
        const double in = (-sign * box.half[axis] - at[axis]) / along[axis];
        leave = std::min(leave, (sign * box.half[axis] - at[axis]) / along[axis]);
        if (in > enter) enter = in, face = axis;
    }
    if (face < 0 || enter >= leave || enter * glm::length(way) < -kBehind) return {};
    glm::dvec3 normal(0);
    normal[face] = along[face] > 0 ? -1 : 1;
    return Met{std::max(enter, 0.0), outOfBox(box, normal)};
}

// Moeller and Trumbore 1997, with edges that overlap.
std::optional<Met> meet(const Triangle& triangle, glm::dvec3 from, glm::dvec3 way) {
    const glm::dvec3 a(triangle.corners[0]), ab = glm::dvec3(triangle.corners[1]) - a,
                                             ac = glm::dvec3(triangle.corners[2]) - a;
    const glm::dvec3 across = glm::cross(way, ac);
    const double volume = glm::dot(ab, across);
    if (std::abs(volume) <= kParallel * glm::length(way) * glm::length(ab) * glm::length(ac)) return {};
    const glm::dvec3 off = from - a, side = glm::cross(off, ab);
    const double u = glm::dot(off, across) / volume, v = glm::dot(way, side) / volume,
                 part = glm::dot(ac, side) / volume;
    if (u < -kEdge || v < -kEdge || u + v > 1 + kEdge || !(part >= 0) || part > 1) return {};
    glm::dvec3 normal = glm::normalize(glm::cross(ab, ac));
    if (glm::dot(normal, way) > 0) normal = -normal;
    return Met{part, normal};
}

std::optional<Depth> depthIn(const SolidBall& ball, glm::dvec3 place) {
    const glm::dvec3 off = place - ball.centre;
    const double distance = glm::length(off);
    if (!(distance < ball.radius)) return {};
    return Depth{ball.radius - distance, distance > 0 ? off / distance : glm::dvec3(0, 1, 0)};
}

std::optional<Depth> depthIn(const SolidBox& box, glm::dvec3 place) {
    const glm::dvec3 at = intoBox(box, place - box.centre), left = box.half - glm::abs(at);
    if (!glm::all(glm::greaterThan(left, glm::dvec3(0)))) return {};
    const int face = left.x < left.y ? (left.x < left.z ? 0 : 2) : (left.y < left.z ? 1 : 2);
    glm::dvec3 normal(0);
    normal[face] = at[face] < 0 ? -1 : 1;
    return Depth{left[face], outOfBox(box, normal)};
}

glm::dvec3 offFrom(const SolidBall& ball, glm::dvec3 place) {
    const glm::dvec3 off = place - ball.centre;
    const double distance = glm::length(off);
    return distance > ball.radius ? (1 - ball.radius / distance) * off : glm::dvec3(0);
}

glm::dvec3 offFrom(const SolidBox& box, glm::dvec3 place) {
    const glm::dvec3 at = intoBox(box, place - box.centre);
    return outOfBox(box, at - glm::clamp(at, -box.half, box.half));
}

// By the corner, edge or face in whose region the place is (Ericson 2005, 5.1.5). Each divisor is a squared length of
// an edge, or a sum of positive areas.
glm::dvec3 offFrom(const Triangle& triangle, glm::dvec3 place) {
    const glm::dvec3 a(triangle.corners[0]), b(triangle.corners[1]), c(triangle.corners[2]);
    const glm::dvec3 ab = b - a, ac = c - a, from_a = place - a, from_b = place - b, from_c = place - c;
    const double a_ab = glm::dot(ab, from_a), a_ac = glm::dot(ac, from_a);
    if (a_ab <= 0 && a_ac <= 0) return from_a;
    const double b_ab = glm::dot(ab, from_b), b_ac = glm::dot(ac, from_b);
    if (b_ab >= 0 && b_ac <= b_ab) return from_b;
    const double at_c = a_ab * b_ac - b_ab * a_ac;
    if (at_c <= 0 && a_ab >= 0 && b_ab <= 0) return from_a - a_ab / (a_ab - b_ab) * ab;
    const double c_ab = glm::dot(ab, from_c), c_ac = glm::dot(ac, from_c);
    if (c_ac >= 0 && c_ab <= c_ac) return from_c;
    const double at_b = c_ab * a_ac - a_ab * c_ac;
    if (at_b <= 0 && a_ac >= 0 && c_ac <= 0) return from_a - a_ac / (a_ac - c_ac) * ac;
    const double at_a = b_ab * c_ac - c_ab * b_ac, past_b = b_ac - b_ab, past_c = c_ab - c_ac;
    if (at_a <= 0 && past_b >= 0 && past_c >= 0) return from_b - past_b / (past_b + past_c) * (c - b);
    const double area = at_a + at_b + at_c;
    return from_a - at_b / area * ab - at_c / area * ac;
}

} // namespace brume
