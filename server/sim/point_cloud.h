// The layouts `file` and `sequence`: particles from a user's own point cloud, and what the user is told about them.
#pragma once

#include <string>
#include <vector>

#include "server/sim/layout.h"

namespace brume {

class Simulation;

// Precondition: the layout is `file`, or `sequence` with one of its files. Throws SceneError if the file is bad.
Placement placePointCloud(const Medium& medium, glm::dvec3 origin);

// Mean optical depth of a medium along the axes of its box. `mass`: integral of the extinction over the volume, m^2.
// `lo`, `hi`: box of the particles' centres. `reach`: three standard deviations of the largest.
double opticalDepth(double mass, glm::dvec3 lo, glm::dvec3 hi, double reach);

// One line: file, points, box, sizes, extinctions, colours, ignored properties, optical depth. Of a sequence: what its
// files are, then the same of the first.
// Precondition of the two below: the simulation is of `scene`, whose points come from files, and has not been
// stepped.
std::string pointCloudLine(const Scene& scene, const Simulation& simulation);
// One line each: points were left out; files are missing; the scene's camera sees no particle. Empty if none is so.
std::vector<std::string> pointCloudWarnings(const Scene& scene, const Simulation& simulation);
// Where Scene::camera_by_points says so, gives the scene a camera that sees all points, in the direction and with the
// angle of its own. Throws SceneError if the points are bad.
void placeCamera(Scene& scene);
// Logs these lines, and returns them. None for other layouts.
std::vector<std::string> tellOfPointCloud(const Scene& scene, const Simulation& simulation);

} // namespace brume
