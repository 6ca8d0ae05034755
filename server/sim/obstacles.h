// Obstacles: what particles cannot pass, where simulation.collide says so: planes, boxes, spheres and the triangles of
// meshes. A particle is its centre here. The same bits on every machine.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/glm.hpp>

#include "common/bounding_tree.h"
#include "common/scene.h"
#include "server/sim/columns.h"
#include "server/sim/lists.h"

namespace brume {

class Obstacles {
public:
    // m, between what stands and a particle that met it there: more than a float's rounding of its place.
    static double gapAt(glm::dvec3 place);

    // Keeps what commands leave as it is: triangles, and the objects of [objects].
    explicit Obstacles(const Scene& scene);

    // The others are those of `lists` from now on. `hash`: hashOf() them; nothing happens where it is known.
    void follow(const SceneLists& lists, uint64_t hash);

    // Particles have moved by dt * velocity. Who met something on the way stops a gap before it, slides along it with
    // what is left of the way, and loses the velocity into it. Who is inside a box, a sphere or the ground comes out
    // the shortest way. Allocates nothing.
    void stop(Columns& columns, Rows rows, float dt) const;

private:
    struct Solid {
        enum class Kind : uint8_t { box, sphere, triangle } kind;
        uint32_t index;
    };
    struct TurnedBox {
        glm::dvec3 centre, half;
        double cosine, sine; // of its angle about the vertical
    };
    struct Ball {
        glm::dvec3 centre;
        double radius;
    };
    struct Met {
        double part; // of the way, in [0, 1]
        glm::dvec3 normal;
    };

    void add(const Box& box);
    void add(const Sphere& sphere);
    void plant(); // the tree
    glm::dvec3 walk(glm::dvec3 from, glm::dvec3 to, glm::dvec3& velocity) const;
    glm::dvec3 outside(glm::dvec3 place, glm::dvec3& velocity) const;
    std::optional<Met> firstOnWay(glm::dvec3 from, glm::dvec3 way) const;
    std::optional<Met> meet(const Solid& solid, glm::dvec3 from, glm::dvec3 way) const;
    Bounds3 boundsOf(const Solid& solid) const;
    template <class Look>
    void near(const Bounds3& box, Look look) const;

    std::vector<Triangle> triangles_;
    std::vector<TurnedBox> boxes_;
    std::vector<Ball> balls_;
    size_t fixed_boxes_ = 0, fixed_balls_ = 0; // of [objects], in front
    std::optional<double> ground_;             // m, the highest plane
    std::vector<Solid> solids_;
    std::vector<BoundingNode> tree_;
    std::optional<uint64_t> hash_;
};

} // namespace brume
