// The typical distance of points.
#pragma once

#include <span>

#include <glm/glm.hpp>

namespace brume {

// Median of the points' distances (m) to their 8th neighbour, or to their last where there are fewer. Of many points
// a sample is asked, for neighbours among all. Outliers hardly matter. Deterministic; a million points take a fraction
// of a second. 0 if there are less than two points, or half of them have so many others in their place.
float spacing(std::span<const glm::vec3> points);

} // namespace brume
