#include "server/sim/obstacles.h"

#include <algorithm>
#include <cmath>

namespace brume {
namespace {

constexpr int kSlides = 4;         // solids that one particle may meet in a tick; then it waits for the next
constexpr double kClearance = 2.2; // standard deviations between a wall and a particle at rest
constexpr double kDeviation = 0.1; // of scale * falloff (shaders/shared/transmittance.h)
constexpr double kRelax = 0.15;    // s, in which the way that is missing shrinks to 1 / e
constexpr double kBetween = 0.25;  // of that pace between two solids: the nearest of several may change every tick
constexpr double kAhead = 4;       // ways to the place of rest: so far it is seen whether a particle heads for a wall

// A way with a margin, for boxes that it may cross: separated along no axis, nor across the way and an axis.
class Crossing {
public:
    Crossing(glm::dvec3 from, glm::dvec3 way)
        : middle_(from + 0.5 * way), half_(0.5 * way), far_(glm::abs(half_)), margin_(2 * Obstacles::gapAt(from)) {}
    bool operator()(const Bounds3& bounds) const {
        glm::dvec3 off, half;
        for (int axis = 0; axis < 3; ++axis) {
            off[axis] = 0.5 * (bounds.lo[axis] + bounds.hi[axis]) - middle_[axis];
            half[axis] = 0.5 * (bounds.hi[axis] - bounds.lo[axis]) + margin_;
            if (std::abs(off[axis]) > half[axis] + far_[axis]) return false;
        }
        return std::abs(off.y * half_.z - off.z * half_.y) <= half.y * far_.z + half.z * far_.y &&
               std::abs(off.z * half_.x - off.x * half_.z) <= half.z * far_.x + half.x * far_.z &&
               std::abs(off.x * half_.y - off.y * half_.x) <= half.x * far_.y + half.y * far_.x;
    }

private:
    glm::dvec3 middle_, half_, far_;
    double margin_;
};

bool isWithin(double metres, const Bounds3& bounds, glm::dvec3 place) {
    const glm::dvec3 off = glm::max(glm::max(bounds.lo - place, place - bounds.hi), glm::dvec3(0));
    return glm::dot(off, off) < metres * metres;
}

// Takes what goes into a face out of a velocity.
void stopInto(glm::dvec3 normal, glm::dvec3& velocity) {
    velocity -= std::min(glm::dot(velocity, normal), 0.0) * normal;
}

// A Gaussian's deviation along a direction, of that along its longest axis.
double widthAlong(glm::dvec3 direction, const gpu::EllipsoidAxes& axes) {
    const glm::dvec3 parts(glm::dot(glm::dvec3(axes.a), direction), glm::dot(glm::dvec3(axes.b), direction),
                           glm::dot(glm::dvec3(axes.c), direction));
    return glm::length(parts);
}

} // namespace

double Obstacles::clearanceOf(const Medium& medium) {
    if (medium.model == kTetrahedraMedium) return 0;
    return medium.model == kUnionMedium ? double(medium.union_radius)
                                        : kClearance * kDeviation * double(medium.falloff);
}

Obstacles::Obstacles(const Scene& scene) : triangles_(scene.triangles) {
    for (size_t i = scene.boxes.size() - scene.laid_out_boxes; i < scene.boxes.size(); ++i)
        boxes_.push_back(solidOf(scene.boxes[i]));
    for (size_t i = scene.spheres.size() - scene.laid_out_spheres; i < scene.spheres.size(); ++i)
        balls_.push_back(solidOf(scene.spheres[i]));
    fixed_boxes_ = boxes_.size(), fixed_balls_ = balls_.size();
}

void Obstacles::follow(const SceneLists& lists, uint64_t hash) {
    if (hash_ == hash) return;
    hash_ = hash;
    boxes_.resize(fixed_boxes_), balls_.resize(fixed_balls_);
    for (const Box& box : lists.boxes) boxes_.push_back(solidOf(box));
    for (const Sphere& sphere : lists.spheres) balls_.push_back(solidOf(sphere));
    ground_.reset();
    for (const Plane& plane : lists.planes) ground_ = std::max(ground_.value_or(-1e300), double(plane.height));
    plant();
}

template <class Look>
auto Obstacles::at(const Solid& solid, Look look) const {
    if (solid.kind == Solid::Kind::box) return look(boxes_[solid.index]);
    if (solid.kind == Solid::Kind::ball) return look(balls_[solid.index]);
    return look(triangles_[solid.index]);
}

void Obstacles::plant() {
    solids_.clear();
    for (uint32_t i = 0; i < boxes_.size(); ++i) solids_.push_back({Solid::Kind::box, i});
    for (uint32_t i = 0; i < balls_.size(); ++i) solids_.push_back({Solid::Kind::ball, i});
    for (uint32_t i = 0; i < triangles_.size(); ++i) solids_.push_back({Solid::Kind::triangle, i});
    std::vector<Bounds3> bounds;
    bounds.reserve(solids_.size());
    for (const Solid& solid : solids_) bounds.push_back(at(solid, [](const auto& one) { return boundsOf(one); }));
    tree_ = bounds.empty() ? std::vector<BoundingNode>() : boundingTree(bounds);
}

// Looks at each solid whose bounds, and those of all that hold it, meet something.
template <class Meets, class Look>
void Obstacles::visit(const Meets& meets, const Look& look) const {
    for (uint32_t i = 0; i < tree_.size();) {
        const BoundingNode& node = tree_[i];
        const bool met = meets(node.bounds);
        if (met && node.item != BoundingNode::kInner) look(solids_[node.item]);
        i = met ? i + 1 : node.next;
    }
}

std::optional<Met> Obstacles::firstSolidOnWay(glm::dvec3 from, glm::dvec3 way) const {
    std::optional<Met> first;
    Crossing crossing(from, way);
    visit([&](const Bounds3& bounds) { return crossing(bounds); },
          [&](const Solid& solid) {
              const std::optional<Met> met = at(solid, [&](const auto& one) { return meet(one, from, way); });
              if (!met || (first && met->part >= first->part)) return;
              first = met;
              crossing = {from, met->part * way};
          });
    return first;
}

std::optional<Met> Obstacles::firstOnWay(glm::dvec3 from, glm::dvec3 way) const {
    std::optional<Met> first = firstSolidOnWay(from, way);
    if (ground_ && way.y < 0 && from.y + way.y < *ground_)
        if (const double part = std::clamp((*ground_ - from.y) / way.y, 0.0, 1.0); !first || part < first->part)
            first = Met{part, {0, 1, 0}};
    return first;
}

// The solid nearest to a place. Its distance is 0, and its normal nothing, where the place is inside.
std::optional<Obstacles::Off> Obstacles::nearest(glm::dvec3 place, double within) const {
    std::optional<Off> least;
    visit([&](const Bounds3& bounds) { return isWithin(within, bounds, place); },
          [&](const Solid& solid) {
              const glm::dvec3 off = at(solid, [&](const auto& one) { return offFrom(one, place); });
              const double distance = glm::length(off);
              if (!(distance < within)) return;
              within = distance;
              least = Off{distance, distance > 0 ? off / distance : glm::dvec3(0)};
          });
    return least;
}

// The nearest place that is not in a box, a ball or the ground, for who was there already.
glm::dvec3 Obstacles::outside(glm::dvec3 place, glm::dvec3& velocity) const {
    const auto leave = [&](glm::dvec3 normal, double depth) {
        place += (depth + gapAt(place)) * normal;
        stopInto(normal, velocity);
    };
    visit([&](const Bounds3& bounds) { return isWithin(2 * gapAt(place), bounds, place); },
          [&](const Solid& solid) {
              if (solid.kind == Solid::Kind::triangle) return;
              const std::optional<Depth> in = solid.kind == Solid::Kind::box ? depthIn(boxes_[solid.index], place)
                                                                             : depthIn(balls_[solid.index], place);
              if (in) leave(in->normal, in->metres);
          });
    if (ground_ && place.y < *ground_) leave({0, 1, 0}, *ground_ - place.y);
    return place;
}

glm::dvec3 Obstacles::walk(glm::dvec3 from, glm::dvec3 to, glm::dvec3& velocity) const {
    glm::dvec3 at = outside(from, velocity), way = to - from;
    for (int slide = 0; slide < kSlides; ++slide) {
        const double length = glm::length(way), gap = gapAt(at);
        if (!(length > 0)) return at;
        // A way that ends within the gap before a face would creep into it, tick after tick.
        const double longer = 1 + gap / length;
        const std::optional<Met> met = firstOnWay(at, longer * way);
        if (!met) return at + way;
        // It stops before the face by the gap, measured across it.
        const double into = -glm::dot(way, met->normal);
        const double part = into > 0 ? std::max(longer * met->part - gap / into, 0.0) : 0;
        at += part * way;
        way *= 1 - part;
        way -= std::min(glm::dot(way, met->normal), 0.0) * met->normal;
        stopInto(met->normal, velocity);
    }
    return at;
}

// A place within the clearance of a solid is led a part of the way off it. Between two solids that is the way to the
// middle. A particle that heads for a wall there loses the velocity into it. One whose way is free, as into an opening,
// is led across its way only: nothing holds it up. The ground needs no clearance: nobody sees its other side.
glm::dvec3 Obstacles::keepOff(glm::dvec3 place, const Off& off, double clearance, double part,
                              glm::dvec3& velocity) const {
    const double room = 2 * clearance - off.distance; // as much as matters
    if (!(off.distance > 0 && room > off.distance)) return place;
    const std::optional<Met> opposite = firstSolidOnWay(place, room * off.normal);
    const double lead = 0.5 * ((opposite ? opposite->part * room : room) - off.distance);
    if (!(lead > 0)) return place;
    glm::dvec3 way = lead * off.normal;
    if (glm::dot(velocity, off.normal) < 0) {
        const glm::dvec3 heading = glm::normalize(velocity);
        const double rest = off.distance + lead; // m, from the wall to where it is led
        const std::optional<Met> ahead = firstSolidOnWay(place, kAhead * rest * heading);
        if (ahead && -glm::dot(heading, ahead->normal) * ahead->part * kAhead < 1)
            stopInto(ahead->normal, velocity);
        else
            way -= glm::dot(way, heading) * heading;
    }
    way *= opposite ? kBetween * part : part;
    // Nothing is nearer than the nearest solid, but for the ground.
    const bool clear = glm::length(way) + gapAt(place) < off.distance && !(ground_ && place.y + way.y < *ground_);
    return clear ? place + way : walk(place, place + way, velocity);
}

void Obstacles::stop(Columns& columns, Rows rows, float dt, const Widths& widths) const {
    if (tree_.empty() && !ground_) return;
    float *const x = columns[Column::x], *const y = columns[Column::y], *const z = columns[Column::z];
    float *const vx = columns[Column::vx], *const vy = columns[Column::vy], *const vz = columns[Column::vz];
    const float* const scale = columns[Column::scale];
    const double part = std::min(double(dt) / kRelax, 1.0);
    for (uint32_t i = rows.begin; i < rows.end; ++i) {
        const glm::dvec3 to(x[i], y[i], z[i]);
        glm::dvec3 velocity(vx[i], vy[i], vz[i]), place = to;
        const glm::dvec3 from = to - double(dt) * velocity;
        double clearance = widths.clearance * double(scale[i]);
        const double way = glm::length(to - from) + 2 * gapAt(from); // who is so far off has met nothing
        const bool grounded = ground_ && std::min(from.y, to.y) < *ground_ + gapAt(to);
        std::optional<Off> off = nearest(to, std::max(way, clearance));
        if (!off && !grounded) continue;
        if (grounded || off->distance < way) {
            place = walk(from, to, velocity);
            off = nearest(place, clearance);
        }
        if (off) {
            if (!widths.axes.empty()) clearance *= widthAlong(off->normal, widths.axes[i]);
            place = keepOff(place, *off, clearance, part, velocity);
        }
        x[i] = float(place.x), y[i] = float(place.y), z[i] = float(place.z);
        vx[i] = float(velocity.x), vy[i] = float(velocity.y), vz[i] = float(velocity.z);
    }
}

} // namespace brume
