// The opaque objects of a scene as the shaders want them.
#pragma once

#include <span>
#include <vector>

#include "common/bounding_tree.h"
#include "common/scene.h"
#include "server/sim/lists.h"
#include "shaders/shared/types.h"

namespace brume {

// Planes, boxes, spheres, in this order: what throws shadows on the medium comes last.
std::vector<gpu::Opaque> opaqueObjects(const Scene& scene);
// The same with the objects of the lists in place of those that the scene begins with.
std::vector<gpu::Opaque> opaqueObjects(Scene scene, const SceneLists& lists);

gpu::Opaque opaqueOf(const Box& box);
gpu::Opaque opaqueOf(const Sphere& sphere);
// Radius of the ball whose outline has the mean area of a box's or a sphere's, m. The mean area of a convex body's
// outline, over all directions, is a quarter of its surface (Cauchy).
float meanRadius(const gpu::Opaque& body);

// A node of a tree, with its item as object. Its box is rounded outward.
gpu::ObjectNode objectNode(const BoundingNode& node);

inline constexpr uint32_t kMostReflecting = 16;
// Indices of the boxes and spheres that reflect most, by area times albedo: at most kMostReflecting, most first.
std::vector<uint32_t> reflectingObjects(std::span<const gpu::Opaque> objects);

// The tree of all that are no planes. Its boxes are rounded outward.
std::vector<gpu::ObjectNode> objectNodes(std::span<const gpu::Opaque> objects);

} // namespace brume
