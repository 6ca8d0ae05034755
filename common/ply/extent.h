// How far a file's points reach, where some may be far from all others.
#pragma once

#include <string>

#include <glm/glm.hpp>

#include "common/ply/ply.h"
#include "common/ply/points.h"

namespace brume::ply {

// A place with the file's axis `up` pointing up. Handedness is kept.
glm::dvec3 turned(glm::dvec3 place, const std::string& up);
// The place of a point, turned, in the file's unit.
glm::dvec3 placeOf(const Points& points, size_t i, const std::string& up);

PlyExtent extentOf(const Points& points, const std::string& up);
// True: a place is further away than the others of such an extent.
bool isFar(const PlyExtent& extent, glm::dvec3 place);
// "1 point is up to 40 km from the others". `unit`: m.
std::string farText(const PlyExtent& extent, double unit);

} // namespace brume::ply
