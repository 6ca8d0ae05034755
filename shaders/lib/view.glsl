// Pictures whose passes run together: z of a workgroup says whose it is. Include after shared/types.h; main() begins with enterView().
// What every pixel pays for runs for one view at a time: CPU drivers load by lane what a constant does not address.
layout(scalar, binding = 1) readonly buffer Views { View views[]; };

Eye eye;
MapRays map_rays;
SlabGrid grid;
uint field_at; // where its field begins

void enterView(uint view) {
    eye = views[view].eye;
    map_rays = views[view].map_rays;
    grid = views[view].grid;
    field_at = views[view].field;
}

#include "shaders/lib/slab_depth.glsl"
