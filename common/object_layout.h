// Places made of many boxes and spheres: what `[objects]` in a scene file stands for.
#pragma once

#include <vector>

#include "common/scene.h"

namespace brume {

struct LaidOut {
    std::vector<Box> boxes;
    std::vector<Sphere> spheres;
};

// As many boxes and spheres together as the layout's count says, on and above y = centre.y; none for kNoObjects. What
// is largest comes first: a smaller count leaves out details. Equal layouts give equal objects.
//   courtyard  69 x 15 x 27 m (x, y, z): wings with arcades and windows around trees
//   street     50 x 30 x 174 m: houses on both sides of a street along z, with lamp posts and trees
//   islands    95 x 60 x 93 m: islands of rock that float, with trees
//   atrium     37 x 20 x 23 m: a hall with columns and galleries under a roof of beams that is open between them
LaidOut layOut(const ObjectLayout& layout);

} // namespace brume
