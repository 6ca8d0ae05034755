// How a Gaussian's mass is spread: its covariance, and the axes of that.
#pragma once

#include <glm/glm.hpp>

namespace brume::volumes {

struct PrincipalAxes {
    glm::dmat3 unit{1};      // columns; at right angles, right-handed
    glm::dvec3 deviation{0}; // standard deviations along them, in no order
};

// Of a symmetric matrix without negative eigenvalues, to 1e-12 of the largest. Jacobi's rotations.
PrincipalAxes principalAxes(const glm::dmat3& covariance);

// The same axes with each deviation within bounds.
glm::dmat3 clampedSpread(const glm::dmat3& covariance, double least, double most);

inline glm::dmat3 ballSpread(double deviation) { return glm::dmat3(deviation * deviation); }

} // namespace brume::volumes
