#include "common/ply/upload_frame.h"

#include <algorithm>

#include <fmt/format.h>

#include "common/scene.h"
#include "common/scene_limits.h"

namespace brume {
namespace {

constexpr double kSmallest = 0.02, kLargest = 2e4; // m, sides of a cloud that a viewer can be near to, and go around
constexpr double kSmall = 1, kLarge = 1000;        // m, least sides of what is shown in their place

// A power of ten.
double unitFor(double side) {
    double unit = 1;
    if (!(side > 0)) return unit;
    if (side < kSmallest)
        while (side * unit < kSmall) unit *= 10;
    if (side > kLargest)
        while (side * unit > 10 * kLarge) unit /= 10;
    return std::clamp(unit, limits::kUnit.lo, limits::kUnit.hi);
}

// True: whatever unit is chosen, such a cloud cannot be looked at.
bool isBeyondUnits(double side) {
    return side > 0 && (side * limits::kUnit.hi < kSmallest || side * limits::kUnit.lo > kLargest);
}

} // namespace

UploadFrame::UploadFrame(const PlyExtent& extent, const UploadOptions& options) {
    const double side = 2 * extent.radius;
    if (!options.unit && isBeyondUnits(side))
        throw SceneError(fmt::format("the points lie within {:.2g} m; allowed: {:.2g} to {:.2g} m, so scale the file",
                                     side, kSmallest / limits::kUnit.hi, kLargest / limits::kUnit.lo));
    unit = options.unit ? *options.unit : unitFor(side);
    origin = options.origin ? *options.origin : originFor(extent, unit);
    if (!options.unit && unit != 1)
        notes.push_back(fmt::format("the points lie within {:.2g} m, and are shown {:g} times as large; unit = 1 keeps "
                                    "metres, and unit = \"mm\" or another says what the file's unit is",
                                    side, unit));
    if (!options.origin && origin != glm::dvec3(0))
        notes.push_back(fmt::format("the scene's origin is moved to the points: [{:.0f}, {:.0f}, {:.0f}]", origin.x,
                                    origin.y, origin.z));
}

} // namespace brume
