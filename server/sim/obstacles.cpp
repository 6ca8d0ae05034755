#include "server/sim/obstacles.h"

#include <algorithm>
#include <cmath>

#include "common/elementary.h"

namespace brume {
namespace {

constexpr int kSlides = 4;          // what one particle may meet in a tick; then it waits for the next
constexpr double kBehind = 1e-9;    // m: so far behind a face its particles are taken to be before it
constexpr double kEdge = 1e-7;      // of a triangle's sides, which overlap by so much: nothing passes between two
constexpr double kParallel = 1e-12; // of a way's cosine, below which it passes a triangle

glm::dvec3 turnedBy(double cosine, double sine, glm::dvec3 v) {
    return {cosine * v.x + sine * v.z, v.y, -sine * v.x + cosine * v.z};
}

Bounds3 around(glm::dvec3 from, glm::dvec3 way) {
    const glm::dvec3 gap(2 * Obstacles::gapAt(from));
    return {glm::min(from, from + way) - gap, glm::max(from, from + way) + gap};
}

bool overlap(const Bounds3& a, const Bounds3& b) {
    return glm::all(glm::lessThanEqual(a.lo, b.hi)) && glm::all(glm::lessThanEqual(b.lo, a.hi));
}

// Takes what goes into a face out of a velocity.
void stopInto(glm::dvec3 normal, glm::dvec3& velocity) {
    velocity -= std::min(glm::dot(velocity, normal), 0.0) * normal;
}

} // namespace

double Obstacles::gapAt(glm::dvec3 place) {
    const glm::dvec3 far = glm::abs(place);
    return 1e-3 + 2e-7 * std::max({far.x, far.y, far.z});
}

Obstacles::Obstacles(const Scene& scene) : triangles_(scene.triangles) {
    for (size_t i = scene.boxes.size() - scene.laid_out_boxes; i < scene.boxes.size(); ++i) add(scene.boxes[i]);
    for (size_t i = scene.spheres.size() - scene.laid_out_spheres; i < scene.spheres.size(); ++i) add(scene.spheres[i]);
    fixed_boxes_ = boxes_.size(), fixed_balls_ = balls_.size();
}

void Obstacles::add(const Box& box) {
    boxes_.push_back({box.centre, 0.5 * glm::dvec3(box.size), cosine(double(box.yaw)), sine(double(box.yaw))});
}
void Obstacles::add(const Sphere& sphere) { balls_.push_back({sphere.centre, double(sphere.radius)}); }

void Obstacles::follow(const SceneLists& lists, uint64_t hash) {
    if (hash_ == hash) return;
    hash_ = hash;
    boxes_.resize(fixed_boxes_), balls_.resize(fixed_balls_);
    for (const Box& box : lists.boxes) add(box);
    for (const Sphere& sphere : lists.spheres) add(sphere);
    ground_.reset();
    for (const Plane& plane : lists.planes) ground_ = std::max(ground_.value_or(-1e300), double(plane.height));
    plant();
}

void Obstacles::plant() {
    solids_.clear();
    for (uint32_t i = 0; i < boxes_.size(); ++i) solids_.push_back({Solid::Kind::box, i});
    for (uint32_t i = 0; i < balls_.size(); ++i) solids_.push_back({Solid::Kind::sphere, i});
    for (uint32_t i = 0; i < triangles_.size(); ++i) solids_.push_back({Solid::Kind::triangle, i});
    std::vector<Bounds3> bounds;
    bounds.reserve(solids_.size());
    for (const Solid& solid : solids_) bounds.push_back(boundsOf(solid));
    tree_ = bounds.empty() ? std::vector<BoundingNode>() : boundingTree(bounds);
}

Bounds3 Obstacles::boundsOf(const Solid& solid) const {
    if (solid.kind == Solid::Kind::sphere) {
        const Ball& ball = balls_[solid.index];
        return {ball.centre - ball.radius, ball.centre + ball.radius};
    }
    if (solid.kind == Solid::Kind::box) {
        const TurnedBox& box = boxes_[solid.index];
        const double c = std::abs(box.cosine), s = std::abs(box.sine);
        const glm::dvec3 half(c * box.half.x + s * box.half.z, box.half.y, s * box.half.x + c * box.half.z);
        return {box.centre - half, box.centre + half};
    }
    Bounds3 bounds;
    for (const glm::vec3& corner : triangles_[solid.index].corners)
        bounds.add({glm::dvec3(corner), glm::dvec3(corner)});
    return bounds;
}

// Looks at each solid whose bounds meet a box.
template <class Look>
void Obstacles::near(const Bounds3& box, Look look) const {
    for (uint32_t i = 0; i < tree_.size();) {
        const BoundingNode& node = tree_[i];
        const bool met = overlap(node.bounds, box);
        if (met && node.item != BoundingNode::kInner) look(solids_[node.item]);
        i = met ? i + 1 : node.next;
    }
}

// Where a way that begins outside enters a solid.
std::optional<Obstacles::Met> Obstacles::meet(const Solid& solid, glm::dvec3 from, glm::dvec3 way) const {
    if (solid.kind == Solid::Kind::sphere) {
        const Ball& ball = balls_[solid.index];
        const glm::dvec3 off = from - ball.centre;
        const double a = glm::dot(way, way), b = glm::dot(off, way), c = glm::dot(off, off) - ball.radius * ball.radius;
        const double root = b * b - a * c;
        if (!(b < 0) || !(root > 0)) return {};
        const double part = std::max((-b - std::sqrt(root)) / a, 0.0);
        if (part > 1) return {};
        return Met{part, glm::normalize(off + part * way)};
    }
    if (solid.kind == Solid::Kind::box) {
        const TurnedBox& box = boxes_[solid.index];
        const glm::dvec3 at = turnedBy(box.cosine, -box.sine, from - box.centre),
                         along = turnedBy(box.cosine, -box.sine, way);
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
        return Met{std::max(enter, 0.0), turnedBy(box.cosine, box.sine, normal)};
    }
    const Triangle& t = triangles_[solid.index]; // Moeller and Trumbore 1997, with edges that overlap
    const glm::dvec3 a(t.corners[0]), ab = glm::dvec3(t.corners[1]) - a, ac = glm::dvec3(t.corners[2]) - a;
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

std::optional<Obstacles::Met> Obstacles::firstOnWay(glm::dvec3 from, glm::dvec3 way) const {
    std::optional<Met> first;
    const auto take = [&](const std::optional<Met>& met) {
        if (met && (!first || met->part < first->part)) first = met;
    };
    near(around(from, way), [&](const Solid& solid) { take(meet(solid, from, way)); });
    if (ground_ && way.y < 0 && from.y + way.y < *ground_)
        take(Met{std::clamp((*ground_ - from.y) / way.y, 0.0, 1.0), {0, 1, 0}});
    return first;
}

// The nearest place that is not in a box, a ball or the ground, for who was there already.
glm::dvec3 Obstacles::outside(glm::dvec3 place, glm::dvec3& velocity) const {
    const auto leave = [&](glm::dvec3 normal, double depth) {
        place += (depth + gapAt(place)) * normal;
        stopInto(normal, velocity);
    };
    near(around(place, glm::dvec3(0)), [&](const Solid& solid) {
        if (solid.kind == Solid::Kind::sphere) {
            const Ball& ball = balls_[solid.index];
            const glm::dvec3 off = place - ball.centre;
            const double distance = glm::length(off);
            if (distance < ball.radius)
                leave(distance > 0 ? off / distance : glm::dvec3(0, 1, 0), ball.radius - distance);
        } else if (solid.kind == Solid::Kind::box) {
            const TurnedBox& box = boxes_[solid.index];
            const glm::dvec3 at = turnedBy(box.cosine, -box.sine, place - box.centre), left = box.half - glm::abs(at);
            if (!glm::all(glm::greaterThan(left, glm::dvec3(0)))) return;
            const int face = left.x < left.y ? (left.x < left.z ? 0 : 2) : (left.y < left.z ? 1 : 2);
            glm::dvec3 normal(0);
            normal[face] = at[face] < 0 ? -1 : 1;
            leave(turnedBy(box.cosine, box.sine, normal), left[face]);
        }
    });
    if (ground_ && place.y < *ground_) leave({0, 1, 0}, *ground_ - place.y);
    return place;
}

glm::dvec3 Obstacles::walk(glm::dvec3 from, glm::dvec3 to, glm::dvec3& velocity) const {
    glm::dvec3 at = outside(from, velocity), way = to - from;
    for (int slide = 0; slide < kSlides; ++slide) {
        const double length = glm::length(way);
        if (!(length > 0)) return at;
        const std::optional<Met> met = firstOnWay(at, way);
        if (!met) return at + way;
        // It stops before the face by the gap, measured across it.
        const double into = -glm::dot(way, met->normal);
        const double part = into > 0 ? std::max(met->part - gapAt(at) / into, 0.0) : 0;
        at += part * way;
        way *= 1 - part;
        way -= std::min(glm::dot(way, met->normal), 0.0) * met->normal;
        stopInto(met->normal, velocity);
    }
    return at;
}

void Obstacles::stop(Columns& columns, Rows rows, float dt) const {
    if (tree_.empty() && !ground_) return;
    float *const x = columns[Column::x], *const y = columns[Column::y], *const z = columns[Column::z];
    float *const vx = columns[Column::vx], *const vy = columns[Column::vy], *const vz = columns[Column::vz];
    for (uint32_t i = rows.begin; i < rows.end; ++i) {
        const glm::dvec3 to(x[i], y[i], z[i]);
        glm::dvec3 velocity(vx[i], vy[i], vz[i]);
        const glm::dvec3 from = to - double(dt) * velocity;
        const bool free = (tree_.empty() || !overlap(tree_.front().bounds, around(from, to - from))) &&
                          !(ground_ && std::min(from.y, to.y) < *ground_ + gapAt(to));
        if (free) continue;
        const glm::dvec3 place = walk(from, to, velocity);
        x[i] = float(place.x), y[i] = float(place.y), z[i] = float(place.z);
        vx[i] = float(velocity.x), vy[i] = float(velocity.y), vz[i] = float(velocity.z);
    }
}

} // namespace brume
