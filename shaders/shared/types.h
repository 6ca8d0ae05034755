// Structs that C++ writes and shaders read: one text, compiled as C++ and as GLSL (scalar layout).
// Metres, world space unless a name says otherwise. "Light space" of a point p: (map.x . p, map.y . p, to_light . p).
#ifndef BRUME_SHARED_TYPES_H
#define BRUME_SHARED_TYPES_H

#include "shaders/shared/depth_layers.h"
#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
namespace brume::gpu {
using uint = uint32_t;
using glm::uvec2;
using glm::uvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;
#endif

struct Particle {
    vec3 centre;
    float scale;   // centre to vertex of its tetrahedron; u = scale * falloff
    vec3 albedo;   // rho
    float sigma_t; // 1/m, extinction at the centre
};

// The semi-axes of a particle that is no ball, over its scale (shared/ellipsoid.h): orthogonal, the longest of
// length 1.
struct EllipsoidAxes {
    vec3 a, b, c;
};

// A directional light. A scene without one has irradiance 0.
struct Light {
    vec3 to_light;   // unit
    vec3 irradiance; // E, W/m^2 per channel, perpendicular to the light
};

// Geometry of the volumetric and the opaque shadow map of a directional light. x, y, to_light: axes of light space.
struct LightMap {
    vec3 x; // with y and to_light a right-handed orthonormal basis
    vec3 y;
    vec3 lo;     // light space bounds of the volumetric shadow map
    uint slices; // number of its planes; the first at hi.z, the last at lo.z
    vec3 hi;
    uint opaque_size; // texels a side of the opaque shadow map
    vec2 opaque_lo;   // light space bounds of the opaque shadow map
    vec2 opaque_hi;
    uvec2 texels; // of a plane of the volumetric shadow map
    vec4 u;       // a world point p has the texture coordinate dot(u, (p, 1)),
    vec4 v;       // down the texture dot(v, (p, 1)),
    vec4 plane;   // and the slice plane dot(plane, (p, 1)), 0 ... slices - 1
};

// Numbers of phaseOfLobes(), shared/phase.h.
struct Phase {
    float part;
    float asymmetry;
    float draine;
    float second;
};

const uint kMostFogs = 4u;

// Extinction sigma_t e^(-falloff (y - base)) between two heights and in a ball (shared/fog.h).
struct Fog {
    vec3 centre;
    float radius;  // from 1e15 on: no ball
    float sigma_t; // 1/m, at y = base
    float falloff; // 1/m
    float base;    // m
    float lo, hi;  // m; -1e30 and 1e30: no limit
    vec3 albedo;
    vec3 emission; // W/(m^2 sr), radiance that it emits per optical depth
    Phase phase;
};

// A point or a spot. A place at the distance d gets intensity / (d^2 + radius^2), within its range and cone.
struct LocalLight {
    vec3 position;
    float range;                    // m; 1e15: without end
    vec3 intensity;                 // W/sr
    float radius;                   // m
    vec3 axis;                      // unit, the way that the light goes
    float cos_outer;                // of the angle to the outer cone; a point: -2
    float cone_width;               // cosine of the inner cone less that of the outer one
    uint shadows;                   // 1: objects and particles shadow it; 0: only fog dims it
    vec3 bound;                     // a ball that holds all it lights: its centre,
    float reach;                    // and its radius, m; 1e15 and more: all
    uint volume;                    // first number of its volume of the particles' depth; kNoVolume: it has none
    uint volume_side;               // directions along a side of the volume's square
    uint volume_shells;             // its distances
    float volume_near, volume_step; // m, distance of the first shell, and between two
    vec3 volume_axis;               // unit, the middle of the cone that its directions fill,
    float volume_cosine;            // and the cosine of the cone's half angle; -2: they are all directions
    float smooth_length;            // m, in which its light varies among particles; 0: pixels' rays must look it up
};

const uint kPixelTile = 16u; // pixels along a side of a bin of local lights, and of a tile of shafts
const uint kNoVolume = 0xffffffffu;
const uint kMostLightSide = 128u; // of LocalLight::volume_side
const uint kMostLightShells = 96u;

// The medium as the union of balls, one for each particle: extinction sigma_t wherever at least one ball is. Rays
// toward the sun find balls in square cells of the plane across it.
struct UnionBalls {
    float radius;  // of a ball, per scale of its particle
    float sigma_t; // 1/m
    vec2 lo;       // light space, m: where the cells begin
    float cell;    // m, their width
    uint side;     // cells along a side; 0: there are no cells
    uint words;    // of a cell: a bit for each particle
    uint cutoff;   // hits from which on a particle is black; 0: none
    uint surfaces; // what surfaces get: kUnionExact ...
};
const uint kUnionExact = 0u, kUnionNearest = 1u, kUnionBinary = 2u, kUnionNone = 3u;

// Light that scatters more than once (shared/multiple.h).
struct Multiple {
    uint octaves;      // 1: it scatters as octaves of single scattering; 0: it does not
    uint cells;        // of the six fluxes, along each side of LightMap::lo ... hi; a multiple of 4; 0: there are none
    uint channels;     // how many colours of light have fluxes: 1 if all do the same, otherwise 3
    float mean_cosine; // of the medium's phase function
    float asymmetry;   // of what is scattered out of the scaled beam, in [-1/3, 1/3]
    vec3 passed;       // part of the extinction that dims the scaled beam, in each channel
    vec3 albedo;       // of what is scattered out of it, in each channel
    // Own light of the medium has other colours than the sun's: the sky sends it in, or particles emit it.
    uint own;        // 1: the fluxes have own light, and are absolute; 0: they are for an irradiance of the sun of 1
    vec3 sun;        // W/m^2, the sun's irradiance in the fluxes: with own light its own, else 1
    vec3 irradiance; // that light which scatters again is multiplied by: with own light 1, else the sun's, W/m^2
    // W/m^2, what enters the cells from outside along each axis of the fluxes: the mean of up and down, and half of
    // their difference.
    vec3 entering;
    vec3 entering_up[3];
};

// Values that all viewers share in one tick.
struct Tick {
    Light sun;     // the first directional light; only it has maps
    LightMap map;  // of the sun
    float falloff; // f
    Phase phase;
    float cut;     // optical depth that one particle may leave out: total of the setting / particle_count
    vec3 ambient;  // uniform radiance scattered in without shadowing
    vec3 emission; // W/(m^2 sr), of particles: emitted() in emission.h
    vec3 cold_albedo;
    uint particle_count;
    uint opaque_count; // number of objects
    uint plane_count;  // of them planes, which come first
    vec3 sky_zenith;
    vec3 sky_horizon;
    float haze; // 1/m
    uint fog_count;
    uint fog_phases; // 1: all fogs have the same phase function; else they differ
    Fog fogs[kMostFogs];
    uint local_light_count;
    uint triangle_count; // of meshes
    // The height map of meshes under the sun (server/effects/object_shadow/mesh_shadow.h): light space bounds, texels a
    // side.
    vec2 mesh_lo;
    vec2 mesh_hi;
    uint mesh_size;
    // Of pictures of red, green and blue that are not drawn together, since the extinction differs.
    float extinction; // part of the particles' extinction
    uint channels;    // bits of red, green and blue: those that are drawn
    UnionBalls balls;
    Multiple multiple;
};
const uint kAllChannels = 7u;

// One eye of one viewer. Affine functions of the pixel: value at pixel (0, 0), and steps to the right and down.
struct Eye {
    vec3 position;
    float near_depth; // view depth of the near plane; nothing in front of it is drawn
    vec3 right;
    float tan_x; // half the picture's width at unit view depth; its position: lib/frustum.glsl
    vec3 up;
    float tan_y;
    vec3 back;
    float exposure;
    uvec2 size;  // pixels
    uint filmic; // 1: filmic tone map, 0: linear
    vec3 ray;    // world direction of unit view depth
    vec3 ray_right;
    vec3 ray_down;
    uint show; // what is drawn in place of the picture: kShowPicture and so on (shared/show.h)
};

// An eye's rays in the sun's volumetric shadow map: texture coordinates and slice plane, affine in pixel and depth.
struct MapRays {
    vec3 eye;   // position of the eye
    vec3 ray;   // step of Eye::ray,
    vec3 right; // of Eye::ray_right,
    vec3 down;  // and of Eye::ray_down
};

const uint kPlane = 0u;
const uint kBox = 1u;
const uint kSphere = 2u;

const uint kMostPlanes = 64u;
const uint kMostBodies = 4096u; // boxes and spheres
const uint kFewObjects = 8u;    // boxes and spheres: so many are asked one by one
const uint kObjectBin = 16u;    // pixels along a side of a bin of objects
const uint kMostShadows = 64u;  // of objects on a ray that are kept apart

struct Opaque {
    vec3 centre; // of a plane: only y counts
    uint kind;
    vec3 half_size; // of a sphere: x is the radius; of a plane: x is its structure, y the structure's size
    float yaw_cos;
    vec3 albedo;
    float yaw_sin;
};

// A node of the tree of boxes and spheres (common/bounding_tree.h).
struct ObjectNode {
    vec3 lo; // m, world
    uint next;
    vec3 hi;
    uint object; // of a leaf its index; kInnerNode: there are nodes in it
};
const uint kInnerNode = 0xffffffffu;

// A triangle of a mesh. It is seen, lit and throws shadows from both sides.
struct Triangle {
    vec3 a, b, c; // m, world
    vec3 albedo;
};
// The nodes of the tree of triangles are there in this many orders. In order i a ray comes to near nodes first whose
// direction is negative along the axes of the bits of i: x, z and y. Of more triangles than kMostInAllOrders there are
// the last kFewMeshOrders, as most eyes look down: every device can bind them all (128 MiB).
const uint kMeshOrders = 8u, kFewMeshOrders = 4u;
const uint kMostInAllOrders = 250000u;

// A particle in cells of the volumetric shadow map, sharpened (shared/sharpen.h).
struct LightParticle {
    vec4 at;    // centre in columns, rows and planes, 0: centre of the first texel; half its optical depth
    vec3 k;     // 1 / (sqrt(2) standard deviations) along columns, rows and planes
    uint reach; // its first group of planes, and 65,536 times its last one; first > last: none
};

// A particle as an ellipsoidal Gaussian for the slabs of one eye, at least as wide as the spacings need. Also used for
// the medium's grid, with nodes in place of metres in eye space.
struct SlabMember {
    vec3 centre;  // right, down and view depth from the eye, m
    float across; // log2(e) / (2 s^2), s = standard deviation across the view
    float along;  // along the view
    float sigma;  // 1/m, extinction at the centre
    vec3 albedo;
    uint reach; // its first sheet of slabs, and 65,536 times its last one; first > last: none. kSmallMember
};
// What a member, or a particle in the sun's map, that is no ball has across its planes: exp(-(xx x^2 + 2 xy x y + yy
// y^2)) in place of its own factors, to the base 2 in members. At (x, y) from its centre its middle lies `tilt` . (x,
// y) further along.
struct Skew {
    float xx, xy, yy;
    vec2 tilt;
};

// Bit of SlabMember::reach. Set: on some plane the member is much narrower than a tile, and is added without
// recurrences.
const uint kSmallMember = 0x8000u;

const uint kMostListed = 1024u;        // members of a tile that are listed together
const uint kMostTogether = 32u;        // sheets of a tile that a workgroup fills
const uint kSlabTile = 8u;             // rays along a side of a tile
const float kLogFogGrowth = 0.2630344; // log2(1.2): each slab before and behind the particles is a fifth thicker

// Grid of rays and slabs of one eye, or of a band of its rows. Node (0, 0) is `margin` spacings up and left of the
// picture's first pixel.
struct SlabGrid {
    uvec2 nodes;
    uint margin;     // nodes before that of the first pixel, in rows and columns
    uint first_row;  // first row of the picture's nodes in the band
    uint rate;       // pixels between neighbouring rays
    float depth;     // m, view depth of the first slab's near face
    float thickness; // m, of a slab
    uint slabs;
    uint sheet;        // slabs that a workgroup computes together: a power of two, divides slabs
    uvec3 lines;       // columns of tiles, rows of tiles, sheets
    uint caster_words; // of a tile of rays: which objects' shadows they may meet (shared/field.h)
    vec3 albedo;       // of all particles
    // With fog: slabs before and behind those of the particles, which grow (lib/slab_depth.glsl).
    uint front, back;
    float front_unit, back_unit; // m
    float fog_step;     // m of view depth; most that the light in fog is taken as linear on where particles shadow it
    float lamp_spacing; // RenderSettings::lamp_spacing; 0: rays hold no lamp's light
    uint soft_edges;    // 1: RenderSettings::soft_edges
};

// One picture, or a band of its rows, whose passes run together with others. Its data begins at these indices, in
// elements, of their common buffers.
struct View {
    Eye eye;
    MapRays map_rays;
    SlabGrid grid;
    uint first, end; // rows of pixels
    uint planes;     // words
    uint members;
    uint bins;
    uint added;
    uint field;
    uint shaded;
    DepthLayers layers;
    uint padding[43]; // any view may be bound alone: offsets are multiples of 256 bytes
};

// Which pixels probe.comp reads, and how they were drawn.
struct ProbePush {
    uint count;                                          // pixels
    uint rate;                                           // pixels between the field's rays
    uint sun_colours, ambient_colours, multiple_colours; // FieldColours
    uint step;                                           // without a field: one pixel is drawn for step x step
};

// The medium's grid (server/methods/grid/medium_grid.h): nodes at origin + spacing * (0, 1, 2 ...), in bricks of
// kSlabTile a side.
struct MediumGrid {
    vec3 origin;   // m
    float spacing; // m
    uvec3 bricks;
    float variance;     // spacings^2, added to the nodes by interpolation
    float least_coarse; // spacings: least standard deviation of a particle that coarse nodes hold
};

// Indirect arguments, written by the cull pass: of vkCmdDraw and of vkCmdDrawMeshTasksEXT.
struct DrawArguments {
    uint vertex_count;
    uint instance_count; // visible particles
    uint first_vertex;
    uint first_instance;
    uint groups_x;
    uint groups_y;
    uint groups_z;
};

#ifdef __cplusplus
static_assert(sizeof(Particle) == 32 && offsetof(Particle, albedo) == 16 && offsetof(Particle, sigma_t) == 28);
static_assert(sizeof(EllipsoidAxes) == 36 && sizeof(Skew) == 20);
static_assert(sizeof(Light) == 24 && sizeof(LightMap) == 128 && offsetof(LightMap, opaque_lo) == 56);
static_assert(sizeof(LocalLight) == 112 && sizeof(Tick) == 756 && offsetof(Tick, map) == 24 &&
              offsetof(Tick, falloff) == 152);
static_assert(sizeof(ObjectNode) == 32 && sizeof(Triangle) == 48);
static_assert(sizeof(Eye) == 116 && offsetof(Eye, size) == 64 && sizeof(MapRays) == 48);
static_assert(offsetof(View, map_rays) == sizeof(Eye)); // a uniform block may hold the two alone
static_assert(sizeof(Opaque) == 48 && offsetof(Opaque, albedo) == 32);
static_assert(sizeof(SlabGrid) == 92 && sizeof(View) == 512 && sizeof(MediumGrid) == 36);
static_assert(sizeof(LightParticle) == 32 && sizeof(DrawArguments) == 28);
} // namespace brume::gpu
#endif

#endif
