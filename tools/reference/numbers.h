// Numbers: all that a reference picture depends on, as a list of numbers whose hash names the picture.
#pragma once

#include <cstdint>
#include <vector>

#include "common/camera.h"
#include "tools/reference/camera.h"
#include "tools/reference/world.h"

namespace brume::reference {

// The structures are taken apart member by member: one that gets another member does not compile until it is counted.
class Numbers {
public:
    void add(double number) { all_.push_back(number); }
    void add(const World& world);
    void add(const Camera& camera);
    void add(const Pose& pose);

    uint64_t hash() const;

private:
    void add(glm::dvec3 v);
    void add(const Blob& blob);
    void add(const UnionMedium::Ball& ball);
    void add(const UnionMedium& medium);
    void add(const SemiAxes& axes);
    void add(const VoxelMedium& medium);
    void add(const TetrahedralMedium::Corner& corner);
    void add(const glm::uvec4& cell);
    void add(const TetrahedralMedium& medium);
    void add(const Fog& fog);
    void add(const LightSource& light);
    void add(const Obstacle& obstacle);
    void add(const Sheet& sheet);
    void add(const PhaseLobes& phase);
    void add(const Frustum& frustum);
    template <class Element>
    void add(const std::vector<Element>& list);

    std::vector<double> all_;
};

} // namespace brume::reference
