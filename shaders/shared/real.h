// Lets the closed forms of this folder compile as C++ (templates over float and double, namespace brume::physics) and
// as GLSL (float) from one text. Approximations and thresholds are made for float; the double versions have the same
// approximation error without the rounding, which is how the tests tell the two apart.
#ifndef BRUME_SHARED_REAL_H
#define BRUME_SHARED_REAL_H

#ifdef __cplusplus
#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
namespace brume::physics {
using glm::mix;
using std::abs;
using std::clamp;
using std::cos;
using std::exp;
using std::floor;
using std::log;
using std::max;
using std::min;
using std::sin;
using std::sqrt;
using std::tan;
template <typename real>
inline real atan(real y, real x) { // GLSL's name
    return std::atan2(y, x);
}
} // namespace brume::physics

#define BRUME_PHYSICS_BEGIN namespace brume::physics {
#define BRUME_PHYSICS_END }
#define BRUME_FN                                                                                                       \
    template <typename real>                                                                                           \
    inline
#define BRUME_STRUCT                                                                                                   \
    template <typename real>                                                                                           \
    struct
#define BRUME_OF(Name) Name<real>
#define BRUME_VEC3 glm::vec<3, real, glm::defaultp>
#else
#define real float
#define BRUME_PHYSICS_BEGIN
#define BRUME_PHYSICS_END
#define BRUME_FN
#define BRUME_STRUCT struct
#define BRUME_OF(Name) Name
#define BRUME_VEC3 vec3
#endif

#endif
