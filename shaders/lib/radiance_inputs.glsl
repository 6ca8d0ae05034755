// What the passes of method `gradients` read.
#include "shaders/shared/constants.h"
#include "shaders/shared/field.h"
#include "shaders/shared/radiance.h"

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;

#include "shaders/blocks/light_depths.glsl"
#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/meshes.glsl"
#include "shaders/blocks/objects.glsl"
#include "shaders/blocks/opaque_shadow.glsl"
#include "shaders/blocks/shadow_volume.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Nodes { float nodes[]; }; // written by grid_fill.comp
layout(scalar) readonly buffer Marks { uint marks[]; };  // lib/grid_marks.glsl
layout(scalar) buffer Counts { uint counts[kLightCounts]; };

layout(push_constant, scalar) uniform Push { LightSampling push; };

Eye eye; // an eye that included functions name; no pass of this method calls them
