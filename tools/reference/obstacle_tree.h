// ObstacleTree: what geometry.h finds among obstacles one by one, in a tree of their bounds. The answers are the same.
#pragma once

#include <span>
#include <vector>

#include "common/bounding_tree.h"
#include "tools/reference/geometry.h"

namespace brume::reference {

class ObstacleTree {
public:
    // `obstacles` must outlive it.
    explicit ObstacleTree(std::span<const Obstacle> obstacles);

    Hit nearest(const Ray& ray) const;
    bool occluded(const Ray& ray, int skip = -1) const;
    // shadowEdges() of all obstacles whose shadow the ray's line may meet; of few obstacles those of all.
    void shadowEdges(const LightSource& light, const Ray& ray, std::vector<double>& t) const;

private:
    // Calls visit(i) for obstacles i in nodes that `enters` is true for, and for planes, until one returns true.
    // Returns whether one did.
    template <class Enters, class Visit>
    bool walk(const Enters& enters, const Visit& visit) const;

    std::span<const Obstacle> obstacles_;
    std::vector<int> planes_, bodies_; // indices of obstacles_
    std::vector<BoundingNode> nodes_;  // items: indices of bodies_
};

} // namespace brume::reference
