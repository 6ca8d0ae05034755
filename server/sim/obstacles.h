// Obstacles: what particles cannot pass, where simulation.collide says so: planes, boxes, spheres and the triangles of
// meshes. A particle's centre never passes, and its width stays before the wall. The same bits on every machine.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "common/bounding_tree.h"
#include "common/scene.h"
#include "server/sim/columns.h"
#include "server/sim/lists.h"
#include "server/sim/solids.h"
#include "shaders/shared/types.h"

namespace brume {

class Obstacles {
public:
    // m, between what stands and a particle that met it there: more than a float's rounding of its place.
    static double gapAt(const glm::dvec3& place) {
        return 1e-3 + 2e-7 * std::max({std::abs(place.x), std::abs(place.y), std::abs(place.z)});
    }

    // m per metre of a particle's scale: so far off solids its centre comes to rest. A Gaussian has 1.4 % of its mass
    // behind a wall there. A ball of a union touches it. Corners of tetrahedra have no width.
    static double clearanceOf(const Medium& medium);

    // Keeps what commands leave as it is: triangles, and the objects of [objects].
    explicit Obstacles(const Scene& scene);

    // The others are those of `lists` from now on. `hash`: hashOf() them; nothing happens where it is known.
    void follow(const SceneLists& lists, uint64_t hash);

    // The part of a way, in [0, 1], after which it meets the first of them from outside. Nothing: it meets none.
    std::optional<double> firstMet(glm::dvec3 from, glm::dvec3 way) const {
        const std::optional<Met> met = firstOnWay(from, way);
        return met ? std::optional(met->part) : std::nullopt;
    }

    struct Widths {                               // of particles
        double clearance = 0;                     // m per m of scale
        std::span<const gpu::EllipsoidAxes> axes; // empty: all are round
    };
    // Particles have moved by dt * velocity. Who met something on the way stops a gap before it, slides along it with
    // what is left of the way, and loses the velocity into it. Who is inside a box, a sphere or the ground comes out
    // the shortest way. Who is within its clearance of a solid is led off it. Allocates nothing.
    void stop(Columns& columns, Rows rows, float dt, const Widths& widths) const;

private:
    struct Solid {
        enum class Kind : uint8_t { box, ball, triangle } kind;
        uint32_t index;
    };
    struct Off {
        double distance; // m, from the nearest point
        glm::dvec3 normal;
    };

    void plant(); // the tree
    glm::dvec3 walk(glm::dvec3 from, glm::dvec3 to, glm::dvec3& velocity) const;
    glm::dvec3 keepOff(glm::dvec3 place, const Off& off, double clearance, double part, glm::dvec3& velocity) const;
    glm::dvec3 outside(glm::dvec3 place, glm::dvec3& velocity) const;
    std::optional<Met> firstOnWay(glm::dvec3 from, glm::dvec3 way) const;
    std::optional<Met> firstSolidOnWay(glm::dvec3 from, glm::dvec3 way) const;
    std::optional<Off> nearest(glm::dvec3 place, double within) const;
    template <class Look>
    auto at(const Solid& solid, Look look) const;
    template <class Meets, class Look>
    void visit(const Meets& meets, const Look& look) const;

    std::vector<Triangle> triangles_;
    std::vector<SolidBox> boxes_;
    std::vector<SolidBall> balls_;
    size_t fixed_boxes_ = 0, fixed_balls_ = 0; // of [objects], in front
    std::optional<double> ground_;             // m, the highest plane
    std::vector<Solid> solids_;
    std::vector<BoundingNode> tree_;
    std::optional<uint64_t> hash_;
};

} // namespace brume
