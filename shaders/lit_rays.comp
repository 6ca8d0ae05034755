#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#extension GL_EXT_control_flow_attributes : require
// Methods `lit` and `gradients`, per eye: coarse rays that read the light which all viewers share, once in each slice.
// Of few lights each is added with the part of it that arrives; of many their fluence. A lane is a ray.
#include "shaders/shared/constants.h"
#include "shaders/shared/froxels.h"
#include "shaders/shared/field.h"
#include "shaders/shared/lit_grid.h"

layout(local_size_x = 8, local_size_y = 8) in;

layout(constant_id = kIdHasOpaque) const bool kHasOpaque = true;
layout(constant_id = kIdHasCasters) const bool kHasCasters = true;
layout(constant_id = kIdHasAmbient) const bool kHasAmbient = true;
layout(constant_id = kIdOneAlbedo) const bool kOneAlbedo = true;

#include "shaders/blocks/eye.glsl"
#include "shaders/blocks/light_bits.glsl"
#include "shaders/blocks/local_lights.glsl"
#include "shaders/blocks/tick.glsl"
layout(scalar) readonly buffer Nodes { float nodes[]; }; // written by grid_fill.comp
layout(scalar) writeonly buffer Volume { vec4 volume[]; };
layout(scalar) readonly buffer Furthest { float furthest[]; }; // m, written by furthest_depths.comp
layout(scalar) readonly buffer Marks { uint marks[]; };        // lib/grid_marks.glsl
layout(scalar) readonly buffer LitNodes { float lit_nodes[]; }; // by lit_grid.comp or radiance_nodes.comp
layout(scalar) readonly buffer SunNodes { float sun_nodes[]; };

layout(push_constant, scalar) uniform Push {
    FroxelGrid froxels;
    MediumGrid medium;
    LitGridShape lit;
    vec3 albedo; // of all particles, where they have one
} push;

#include "shaders/lib/grid_marks.glsl"
#include "shaders/lib/medium_nodes.glsl"
#include "shaders/lib/light.glsl"
#include "shaders/lib/fog.glsl"
#include "shaders/lib/objects.glsl"
#include "shaders/lib/local_lights.glsl"
#include "shaders/lib/local_light_depth.glsl"
#include "shaders/lib/occluded.glsl"
#include "shaders/lib/near_lights.glsl"
#include "shaders/lib/froxel_march.glsl"
#include "shaders/lib/froxel_light.glsl"
#include "shaders/lib/spread.glsl"

float particlesIn(float near, float far, out vec3 scattering) { return particlesAtSample(near, far, scattering); }

float litPart(uint i, vec3 x, vec3 away) { return isOccluded(x, -away, true) ? 0 : 1; }

// Where a place lies among the nodes.
uint first_node, node_row, node_sheet; // index of the first of eight; from one row and one sheet to the next
vec3 node_part;                        // 0 ... 1, of the way to the next ones

// False: x is not in the grid.
bool enterNodes(vec3 x) {
    const vec3 at = (x - push.lit.origin) / push.lit.spacing;
    const uvec3 size = push.lit.bricks * kSlabTile;
    // Without nodes it is infinite or no number.
    if (!(all(greaterThanEqual(at, vec3(0))) && all(lessThan(at, vec3(size) - 1)))) return false;
    const uvec3 cell = uvec3(at);
    node_part = at - vec3(cell);
    node_row = size.x;
    node_sheet = size.y * size.x;
    first_node = cell.z * node_sheet + cell.y * node_row + cell.x;
    return true;
}

float sunBetween() {
    const uint n = first_node, m = n + node_sheet;
    const vec4 below = vec4(sun_nodes[n], sun_nodes[n + 1], sun_nodes[n + node_row], sun_nodes[n + node_row + 1]);
    const vec4 above = vec4(sun_nodes[m], sun_nodes[m + 1], sun_nodes[m + node_row], sun_nodes[m + node_row + 1]);
    const vec4 here = mix(below, above, node_part.z);
    return mix(mix(here.x, here.y, node_part.x), mix(here.z, here.w, node_part.x), node_part.y);
}

// A number of the nodes around the place.
float numberAt(uint corner, uint number) { return lit_nodes[push.lit.numbers * corner + number]; }
float numberBetween(uint number) {
    const uint n = first_node, m = n + node_sheet;
    const vec4 below = vec4(numberAt(n, number), numberAt(n + 1, number), numberAt(n + node_row, number),
                            numberAt(n + node_row + 1, number));
    const vec4 above = vec4(numberAt(m, number), numberAt(m + 1, number), numberAt(m + node_row, number),
                            numberAt(m + node_row + 1, number));
    const vec4 here = mix(below, above, node_part.z);
    return mix(mix(here.x, here.y, node_part.x), mix(here.z, here.w, node_part.x), node_part.y);
}

// What the kept fluence of a channel scatters. The more its directions agree, the more of it counts as coming from
// their mean: for one light that is exact.
float scatteredBetween(uint c, vec3 even) {
    const float fluence = numberBetween(4 * c + 3);
    if (!(fluence > 0)) return 0;
    const vec3 way = vec3(numberBetween(4 * c), numberBetween(4 * c + 1), numberBetween(4 * c + 2));
    const float directed = min(length(way), fluence);
    float sum = (fluence - directed) * 0.07957747154594767 * even[c];
    if (directed > 1e-4 * fluence) sum += directed * scatteredFrom(way / directed)[c];
    return sum;
}

float exact_part; // share of a light whose arriving part is looked up where it scatters
vec3 kept_part;   // the rest of the light, times the arriving part that nodes keep

vec3 addedPart(uint i, vec3 x, vec3 away, float distance) {
    return exact_part > 0 ? kept_part + exact_part * arrivingPart(i, x, away, distance) : kept_part;
}

// Adds lights one by one: with the parts that nodes keep of them, or what these leave out. in_grid: true if x is.
void addLights(vec3 x, bool in_grid, float near, float far, inout vec3 scattered) {
    const bool of_colours = in_grid && push.lit.keeps == kKeepsColours, of_lights = push.lit.keeps == kKeepsLights;
    vec3 colours = vec3(0);
    if (of_colours) [[unroll]] for (uint c = 0; c < 3; ++c) colours[c] = numberBetween(c);
    const uint bin = binOf(ray_pixel);
    [[dont_unroll]] for (uint word = 0; word < lightWords(); ++word)
        [[dont_unroll]] for (uint bits = light_bits[bin + word]; bits != 0; bits &= bits - 1) {
            const uint i = 32 * word + findLSB(bits);
            const float kept = in_grid ? keptPart(length(x - local_lights[i].position)) : 0;
            exact_part = 1 - kept;
            kept_part = kept * colours;
            if (in_grid && of_lights) kept_part = vec3(kept * numberBetween(i));
            if (exact_part > 0 || kept_part != vec3(0)) scattered += ofLocalLight(i, near, far);
        }
}

void addSlice(float near, float far, inout vec3 scattered, out float depth) {
    depth = mediaOf(near, far, scattered);
    if (!(depth > 0)) return;
    const vec3 x = eye.position + 0.5 * (near + far) * ray_dir;
    const bool in_grid = enterNodes(x);
    if (tick.sun.irradiance != vec3(0)) {
        float sun = in_grid ? sunBetween() : sunThrough(x);
        if (!in_grid && kHasCasters && sun > 0 && isOccluded(x, kFarAway * tick.sun.to_light, true)) sun = 0;
        if (sun > 0) scattered += tick.sun.irradiance * sun * scatteredFrom(-tick.sun.to_light);
    }
    if (!kHasLocalLights) return;
    if (in_grid && push.lit.keeps == kKeepsFluence) {
        vec3 even = of_particles;
        [[dont_unroll]] for (uint i = 0; i < fogCount(); ++i) even += of_fogs[i];
        [[dont_unroll]] for (uint c = 0; c < 3; ++c) scattered[c] += scatteredBetween(c, even);
    }
    addLights(x, in_grid, near, far, scattered);
}

void main() {
    const uvec2 ray = spreadInvocation().xy;
    const vec2 at = pixelOfRay(ray);
    ray_pixel = min(uvec2(at), eye.size - 1);
    ray_unit = normalize(rayDirection(at));
    march(ray);
}
