// Views whose passes run together: z of a workgroup is the index of its view. Include after shared/types.h; main()
// calls enterView() first. Passes with much work per pixel run for one view at a time: CPU drivers load lane by lane
// if an address is no constant.
layout(scalar) readonly buffer Views { View views[]; };

Eye eye;
MapRays map_rays;
SlabGrid grid;
DepthLayers layers;
uint field_at; // index at which its field begins

void enterView(uint view) {
    eye = views[view].eye;
    map_rays = views[view].map_rays;
    grid = views[view].grid;
    layers = views[view].layers;
    field_at = views[view].field;
}

#include "shaders/lib/slab_depth.glsl"
