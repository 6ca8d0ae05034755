// Ids of the shaders' specialization constants, one list compiled as C++ and as GLSL. An id has the same meaning in all
// shaders. Shaders write `layout(constant_id = kIdStep) const uint kStep = 4;`, C++ writes `{gpu::kIdStep, step}`.
#ifndef BRUME_SHARED_CONSTANTS_H
#define BRUME_SHARED_CONSTANTS_H

#ifdef __cplusplus
#include <cstdint>
namespace brume::gpu {
using uint = uint32_t;
#endif

// The scene: code for what it lacks is left out.
const uint kIdHasOpaque = 0u;  // bool: objects hide the medium and shadow it
const uint kIdHasCasters = 1u; // bool: some of these objects cast shadows on the medium
const uint kIdHasLobe = 2u;    // bool: anisotropy > 0
const uint kIdHasAmbient = 3u; // bool: ambient radiance > 0
const uint kIdMayBeCut = 4u;   // bool: objects or the near plane may end a ray inside a particle
const uint kIdOneAlbedo = 5u;  // bool: all particles have the same albedo
const uint kIdPlanes = 6u;     // number of planes
const uint kIdBoxes = 7u;      // number of boxes, and of spheres; with many: 1 if there are some, else 0
const uint kIdSpheres = 8u;
const uint kIdManyObjects = 31u;    // bool: there are more than kFewObjects boxes and spheres
const uint kIdHasFog = 28u;         // bool: there is fog
const uint kIdHasGlow = 29u;        // bool: some fog emits light
const uint kIdHasEmission = 63u;    // bool: particles emit light
const uint kIdHasLocalLights = 30u; // bool: there are points or spots
const uint kIdHasMeshes = 32u;      // bool: there are meshes
const uint kIdHasStructure = 33u;   // bool: some planes have a structure (ground.h)
const uint kIdUnion = 36u;          // bool: particles are balls whose union is the medium
const uint kIdEllipsoids = 62u;     // bool: particles have three axes (ellipsoid.h)
const uint kIdHasGlass = 60u;       // bool: there are sheets of glass: pictures are sums of layers (glass.h)

// Lanes of a workgroup that is one subgroup, where lanes work on one thing together: a power of two, at most 8
// (Device::lanesTogether()). Slabs of a sheet, columns of a tile of the volumetric shadow map, planes of a brick.
const uint kIdLanes = 9u;
const uint kIdLockstep = 10u; // bool: those lanes are all of their subgroup, and run together without a barrier

// Method `isv`.
const uint kIdQuadrature = 11u; // 0: Simpson, 1: in transmittance, 2: analytic, 3: Taylor
const uint kIdSteps = 12u;
const uint kIdFading = 37u;        // bool: extinction fades from a particle's centre; else it is even
const uint kIdSoftShadows = 38u;   // bool: shadows of objects in the medium are means over 5x5 texels
const uint kIdLegacyTerm = 39u;    // bool: the dissertation's term for multiple scattering is added
const uint kIdTurned = 46u;        // bool: each tetrahedron is turned by chance (orientation.h)
const uint kIdDropsNear = 47u;     // bool: particles that the near plane meets are not drawn
const uint kIdEarlyReturn = 48u;   // which intervals are left out: kReturnSum and so on
const uint kIdTaylorStep = 49u;    // bool: the Taylor series has a step of its own
const uint kIdTaylorShadows = 51u; // bool: objects shadow the medium with the Taylor series, too
const uint kReturnSum = 0u, kReturnFixed = 1u, kReturnNone = 2u;

// Light that scatters more than once.
const uint kIdOwnLight = 53u;   // bool: Multiple::own (types.h)
const uint kIdCellMatter = 54u; // bool: cells have their own albedo, and what they emit
const uint kIdMediumGlow = 55u; // bool: surfaces get the medium's light

// The volumetric shadow map.
const uint kIdFronts = 52u; // bool: a particle's whole optical depth counts from the plane behind its front on

// Method `tiles`.
const uint kIdCached = 13u;        // bool: light is looked up once for each particle, not at each pixel
const uint kIdPixelsPerLane = 14u; // pixels of a lane's run
const uint kIdTileLanes = 15u;     // lanes of a workgroup

// Methods `slabs` and `grid`: the field of rays.
const uint kIdCubic = 17u;           // bool: the grid is interpolated by cubics; else linearly, and it is finer
const uint kIdCoarse = 26u;          // bool: the grid's coarse nodes are filled; else the others
const uint kIdHasCoarse = 27u;       // bool: the grid has coarse nodes
const uint kIdRate = 18u;            // pixels between neighbouring rays
const uint kIdSunColours = 19u;      // FieldColours::sun (field.h)
const uint kIdAmbientColours = 20u;  // FieldColours::ambient
const uint kIdMultipleColours = 44u; // FieldColours::multiple
const uint kIdScattering = 45u;      // kScatteringOctaves and so on (multiple.h)

// Method `froxels`.
const uint kIdShadows = 34u; // of objects: kShadowsByMap and so on (froxels.h)
const uint kIdHistory = 35u; // bool: cells keep a part of what an eye's last picture had

// Method `march`.
const uint kIdLightsAtSample = 40u; // bool: a slice's inverse squares are those at its sample; else their means
const uint kIdJitter = 41u;         // what the pattern moves: kJitterOffset and so on (march.h)
const uint kIdBlur = 42u;           // weights: kBlurRow14 and so on
const uint kIdDown = 43u;           // bool: the blur goes down the columns; else along the rows

// The picture.
const uint kIdStep = 21u;   // pixels between neighbouring nodes of a picture that is shaded or drawn coarsely
const uint kIdDrawn = 22u;  // bool: `radiance` holds the medium already
const uint kIdKeep = 23u;   // bool: the radiance of every pixel is stored for later reading
const uint kIdFull = 24u;   // bool: R, G, B of all pixels instead of Y, Cb, Cr
const uint kIdBlocks = 25u; // blocks of 8x2 pixels that a lane makes: 3 are whole cells of rates 3, 6, 12

const uint kIdDepthLayers = 61u; // bool: some views of the group have layers with depth (depth_layers.h)

// Views of how a picture is made.
const uint kIdShow = 50u; // what is drawn in place of the picture: kShowWasted and so on (show.h)

#ifdef __cplusplus
} // namespace brume::gpu
#endif

#endif
