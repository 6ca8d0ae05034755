// What the double-precision reference says of a world, computed once, in threads, and kept on disk.
//
// A file holds the truth of one world, camera and tolerance. Files are in `build/truth`, or in the folder that
// BRUME_TRUTH names; where it is empty nothing is kept. A file that is damaged, or comes from another build of the
// reference, is made anew. All may be deleted at any time.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "tools/reference/medium_reference.h"
#include "tools/reference/numbers.h"
#include "tools/reference/tracker.h"

namespace brume::test {

// As reference::PixelResult has them.
struct TruePixel {
    glm::dvec3 total{0};
    double transmittance = 1;
    bool edge = false;
};
std::vector<TruePixel> truthOf(const reference::World& world, const reference::Camera& camera,
                               std::span<const glm::uvec2> pixels, double tolerance);

// reference::render() and reference::track().
reference::Picture truePicture(const reference::World& world, const reference::Camera& camera, double tolerance);
reference::TrackedPicture truePaths(const reference::World& world, const reference::Camera& camera, int samples);

// `count` numbers that follow from `key` and from the reference's code: read from disk, or made and kept there.
std::vector<double> kept(const reference::Numbers& key, size_t count, const std::function<std::vector<double>()>& make);

} // namespace brume::test
