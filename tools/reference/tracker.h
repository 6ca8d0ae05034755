// Multiple scattering by random paths: free flights by delta tracking (Woodcock 1965) in cells with their own bounds,
// flights in fog and tetrahedra by inversion, next-event estimation to every light past the objects with ratio tracking
// (Novak et al. 2014). Unbiased.
#pragma once

#include <cstdint>
#include <vector>

#include "tools/reference/camera.h"
#include "tools/reference/world.h"

namespace brume::reference {

struct TrackSettings {
    int samples = 64;       // paths per pixel, all through its centre; at least 2
    int orders = 1'000'000; // scattering events along a path; 1: single scattering
    uint64_t seed = 1;      // equal seeds give equal pictures, whatever the threads
    unsigned threads = 0;   // 0: as many as the machine has
};

// Mean radiance over paths, of medium, surfaces and sky. 95 % of exact values lie within 1.96 standard errors of it.
struct TrackedPicture {
    int width = 0, height = 0;
    std::vector<glm::dvec3> radiance, standard_error;
};

// Throws std::invalid_argument unless the world's support is full, its composition overlapping and it is not coloured.
// The camera sees the sky; scattered rays that leave the medium meet World::ambient from all directions, and with
// World::sky_lights the sky behind. Those that meet an obstacle meet its shading (Lighting::surface). With
// World::onto_surfaces what the camera sees of obstacles has the light of the medium, too. Sheets of glass are on the
// camera's rays alone.
TrackedPicture track(const World& world, const Camera& camera, const TrackSettings& settings = {});

} // namespace brume::reference
