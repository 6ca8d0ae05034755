// What the passes of method `gradients` are bound to.
#include "shaders/shared/constants.h"
#include "shaders/shared/field.h"
#include "shaders/shared/radiance.h"

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;

layout(scalar, binding = 0) uniform TickBlock { Tick tick; };
layout(scalar, binding = 2) readonly buffer Nodes { float nodes[]; }; // written by grid_fill.comp
layout(scalar, binding = 5) readonly buffer Marks { uint marks[]; };  // lib/grid_marks.glsl
layout(binding = 6) uniform sampler2DArray shadow_volume;
layout(binding = 7) uniform sampler2D opaque_shadow;
layout(scalar, binding = 8) readonly buffer Lights { LocalLight local_lights[]; };
layout(scalar, binding = 10) readonly buffer Depths { float light_depths[]; };
layout(scalar, binding = 11) readonly buffer Objects { Opaque objects[]; };
layout(scalar, binding = 12) readonly buffer ObjectNodes { ObjectNode object_nodes[]; };
layout(scalar, binding = 13) readonly buffer Triangles { Triangle triangles[]; };
layout(scalar, binding = 14) readonly buffer MeshNodes { ObjectNode mesh_nodes[]; };
layout(scalar, binding = 15) buffer Counts { uint counts[kLightCounts]; };

layout(push_constant, scalar) uniform Push { LightSampling push; };

Eye eye; // what is included names it; nothing here reads it
