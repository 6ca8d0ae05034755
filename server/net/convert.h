// Converts between the protocol's vectors and glm's.
#pragma once

#include <cmath>

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "common/camera.h"
#include "protocol/brume_generated.h"

namespace brume::net {

inline glm::vec3 toGlm(const wire::Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline glm::quat toGlm(const wire::Quat& q) { return {q.w(), q.x(), q.y(), q.z()}; }
inline Frustum toFrustum(const wire::Frustum& f) { return {f.left(), f.right(), f.up(), f.down()}; }
inline wire::Frustum toWire(const Frustum& f) { return {f.left, f.right, f.up, f.down}; }
inline wire::Vec3 toWire(const glm::vec3& v) { return {v.x, v.y, v.z}; }
inline wire::Quat toWire(const glm::quat& q) { return {q.x, q.y, q.z, q.w}; }

} // namespace brume::net
