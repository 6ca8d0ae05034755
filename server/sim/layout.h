// Where the particles of a resting medium stand: layouts cube, tubes, cumulus and file.
#pragma once

#include <vector>

#include "common/scene.h"

namespace brume {

// One entry per particle; the lists that only a file can bring are empty otherwise.
struct Placement {
    std::vector<glm::vec3> position; // m, world
    std::vector<float> scale;        // m
    std::vector<float> multiplier;   // of the medium's extinction
    std::vector<float> sigma_t;      // 1/m, instead
    std::vector<glm::vec3> albedo;   // instead of the medium's
};

// The same for the same medium, whatever the compiler. Throws SceneError when the medium's file is bad.
// `origin`: the scene's, which a file's places count from. Precondition: the layout is not `emitter`.
Placement place(const Medium& medium, glm::dvec3 origin = glm::dvec3(0));

// `count` positions and scales that fill a cumulus of `extent` width standing on y = 0 over the origin.
Placement cumulus(const Medium& medium);

} // namespace brume
