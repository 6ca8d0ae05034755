#include "server/sim/layout.h"

#include "common/random.h"
#include "server/sim/point_cloud.h"

namespace brume {

namespace {

Placement cube(const Medium& medium) {
    Placement out;
    Random random(medium.seed);
    for (uint32_t i = 0; i < medium.count; ++i) {
        out.position.push_back(random.inBox() * (0.5f * medium.extent));
        out.scale.push_back(random.uniform(medium.scale.lo, medium.scale.hi));
    }
    return out;
}

// Two tubes at right angles, the one along z above the one along x (seed 003 section 4.1.1).
Placement tubes(const Medium& medium) {
    const float radius = 0.12f * medium.extent,
                lift = 0.16f * medium.extent; // a gap of two thirds of a radius between them
    Placement out;
    Random random(medium.seed);
    for (uint32_t i = 0; i < medium.count; ++i) {
        const glm::vec2 across = random.inDisc() * radius;
        const float along = random.uniform(-0.5f, 0.5f) * medium.extent;
        out.position.push_back(i % 2 == 0 ? glm::vec3(across.x, across.y + lift, along)
                                          : glm::vec3(along, across.y - lift, across.x));
        out.scale.push_back(random.uniform(medium.scale.lo, medium.scale.hi));
    }
    return out;
}

Placement beforeMoving(const Medium& medium, glm::dvec3 origin, const Volume* volume) {
    switch (medium.layout) {
    case Layout::tubes:
        return tubes(medium);
    case Layout::cumulus:
        return cumulus(medium);
    case Layout::file:
        return placePointCloud(medium, origin);
    case Layout::volume:
        return placeVolume(medium, *volume);
    case Layout::cube:
    case Layout::emitter:
    case Layout::live:
    case Layout::none:
    case Layout::sequence:
        break;
    }
    return cube(medium);
}

} // namespace

Placement place(const Medium& medium, glm::dvec3 origin, const Volume* volume) {
    Placement out = beforeMoving(medium, origin, volume);
    Random random(medium.seed, 0x6d756c74); // a stream of its own
    out.multiplier.reserve(out.position.size());
    for (glm::vec3& position : out.position) {
        position += medium.centre;
        out.multiplier.push_back(random.uniform(medium.multiplier.lo, medium.multiplier.hi));
    }
    return out;
}

} // namespace brume
