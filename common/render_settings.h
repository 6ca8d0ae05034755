// What the renderer is asked for: [render] of a scene, and [render.NAME] of each method.
#pragma once

#include <cstdint>
#include <string>

namespace brume {

// A number that the server chooses: "auto" in a scene.
inline constexpr uint32_t kAuto = 0;

// Settings of one method each: [render.NAME] in a scene.
struct IsvSettings {
    std::string quadrature = "simpson"; // simpson | transmittance | analytic | taylor
    uint32_t steps = 2;                 // simpson 1...10, transmittance 1...3
    bool fading = true;                 // False: all of a tetrahedron has the extinction of its centre
    bool soft_shadows = false;          // True: shadows of objects in the medium are means over 5x5 texels
    float multiple = 0;                 // m, in [0, 1]: of a term for multiple scattering that is not physical
    // As the dissertation or its program has it.
    std::string orientation = "aligned"; // aligned | random: of the tetrahedra, random by a particle's number
    std::string near = "clip";           // clip | drop: particles that the near plane meets
    std::string early_return = "sum";    // sum | fixed | none: which intervals are left out as too thin
    float taylor_step = kAuto;           // taylor: m between its nodes; auto: 1/16 of the interval
    bool taylor_shadows = true;          // taylor. False: objects do not shadow the medium

    bool operator==(const IsvSettings&) const = default;
};
struct TetrahedraSettings {
    uint32_t nodes = 2; // 1...3: places in each tetrahedron on a ray for which light is looked up

    bool operator==(const TetrahedraSettings&) const = default;
};
struct TilesSettings {
    std::string quadrature = "cached"; // cached | hermite
    float light_tolerance = 0.2f;      // cached: how far light may be from linear on a particle, as a part of 1
    float least_transmittance = 1e-3f; // where a ray may end; what lies behind counts for no more than that
    std::string light = "fit";         // cached: fit, linear on a particle; path: one value, of the union of balls

    bool operator==(const TilesSettings&) const = default;
};
struct GridSettings {
    float spacing = kAuto; // standard deviations between nodes, at most 1; auto: 0.5. Below 0.25 sampling is cubic

    bool operator==(const GridSettings&) const = default;
};

// Froxels: cells of an eye's view volume, `pixels` wide, cut by slices that grow with their distance. Methods froxels,
// lit and gradients march through them.
struct FroxelSettings {
    uint32_t pixels = 8;         // between neighbouring rays, 1...32
    uint32_t slices = 128;       // along every ray, 8...512
    bool jitter = false;         // froxels. True: each tick's samples lie elsewhere within their slices
    float history = 0;           // froxels: part of a cell's light that is kept from an eye's last picture, up to 0.98
    std::string shadows = "ray"; // froxels: how objects shadow the medium: none | map | ray | grid | hybrid

    bool operator==(const FroxelSettings&) const = default;
};
// Light past objects, kept in voxels of world space.
struct ShadowGridSettings {
    float voxel = kAuto;             // m; auto: 1/200 of the longest side of what it covers
    std::string values = "coverage"; // bits | coverage: of a voxel's centre, or the part of the voxel that is lit
    std::string lookup = "linear";   // nearest | linear
    bool parity = false;             // True: each update makes every other layer of voxels
    bool retrace = false;            // True: every tick makes all of it again, though nothing has moved

    bool operator==(const ShadowGridSettings&) const = default;
};

// Method gradients: light is computed at few places, and interpolated to the nodes that method lit reads. Both methods
// have nodes `spacing` apart.
struct RadianceSettings {
    // exact: computed at every node. rbf, gradient: at samples in spheres, without and with their gradients (Ren et al.
    // 2008). nested: at every fourth node, and between these where interpolation errs.
    std::string interpolation = "nested";
    std::string quantity = "factor";  // radiance | factor: what is interpolated; the factor is the part that arrives
    std::string weights = "gaussian"; // printed | gaussian: how samples in spheres are weighted
    float error = 0.02f;              // a sample that errs by more is split: criterion
    // The error of a sample of rbf or gradient. opacity: a part of all light, times opacity. printed: that part times
    // the cube of the radius of the sample's sphere, times density and the transmittance to an eye (Ren et al., eq. 5).
    std::string criterion = "opacity";
    std::string firsts = "particles"; // rbf, gradient: particles | strata: where the first samples are
    float near = 3;                   // spacings from a light within which it is added exactly, 0...16; 0: nowhere
    uint32_t levels = 3;              // number of grids that samples are split into, 0...3
    float spacing = kAuto;            // m between nodes; auto: as the particles need, or 1/96 of what they cover
    float step = kAuto;      // spacings between places of a march toward a light; auto: the light's volume is read
    uint32_t samples = 1024; // rbf, gradient: number of first samples, at most: particles, or strata

    bool operator==(const RadianceSettings&) const = default;
};

// The union of balls as light passes it: method sprites, tiles with light = "path", and surfaces of a union medium.
struct PathSettings {
    uint32_t groups = 1;            // each tick, light is computed for one of so many groups, 1...64
    uint32_t cutoff = 0;            // hits of a ray from which on a particle is black, up to 256; 0: none
    std::string surfaces = "exact"; // exact | nearest | binary | none: what surfaces get through a union medium

    bool operator==(const PathSettings&) const = default;
};
// Method sprites: pictures of particles that face the camera.
struct SpritesSettings {
    std::string light = "path"; // path | none: whether other particles shadow a particle
    std::string maps = "baked"; // baked | even | files: light on a picture from six sides
    float size = 1.3f;          // half a picture's side, in radii of its ball

    bool operator==(const SpritesSettings&) const = default;
};
// Method march: samples along every pixel's ray, dithered and blurred.
struct MarchSettings {
    uint32_t samples = 8;          // 1...256
    std::string dither = "bayer8"; // none | white | bayer4 | bayer8 | ign | blue
    std::string jitter = "offset"; // offset | stratified | opacity
    std::string blur = "row14";    // none | row14 | printed | box8

    bool operator==(const MarchSettings&) const = default;
};

// With scattering = "propagation": light that goes along six directions through cells of the medium's bounds, once a
// tick for all viewers.
struct PropagationSettings {
    uint32_t cells = 24;     // along each side, 8...64; counted up to a multiple of 4
    uint32_t iterations = 4; // on the finest of three grids, 1...256; twice and four times as many on the others
    // Along each side of a plane, box or sphere whose reflected sunlight the medium gets, 0...16; 0: it gets none.
    uint32_t surface_parts = 4;
    bool onto_surfaces = false; // True: surfaces get the light that the medium scatters and emits

    bool operator==(const PropagationSettings&) const = default;
};

struct MethodSettings {
    IsvSettings isv;
    TetrahedraSettings tetrahedra;
    TilesSettings tiles;
    GridSettings grid;
    FroxelSettings froxels;
    ShadowGridSettings shadow_grid;
    RadianceSettings radiance;
    PathSettings path;
    SpritesSettings sprites;
    MarchSettings march;
    PropagationSettings propagation;

    bool operator==(const MethodSettings&) const = default;
};

// What the renderer is asked for; changed by commands while the server runs.
struct RenderSettings : MethodSettings {
    std::string method = "auto"; // a name of server/methods/list.h, or auto: what server/plan chooses
    float error = 5e-3f;         // auto: relative RMSE of a picture against the true medium, at most
    float flip = 1e-2f;          // auto: and mean FLIP
    // slabs, grid: pixels between rays, 1...16; auto: from the medium's band limit. Other methods: pixels between those
    // drawn, 2, 4 or 8 at most, but for edges of objects and shadows; auto: every pixel is drawn.
    uint32_t rate = kAuto;
    uint32_t slabs = kAuto;   // slabs, grid: along every ray, up to 512; auto: from the band limit
    uint32_t shading = kAuto; // slabs, grid: pixels between shaded ones, 1, 2, 4 or 8; auto: from the rays' spacing
    // slabs, grid: rays hold the light that particles scatter of points and spots where rays and slabs are at most so
    // many of the lengths apart in which it varies, up to 10. Pixels look up that of other lamps; auto: 0.25.
    float lamp_spacing = kAuto;
    // slabs, grid. True: edges of shafts and of lamps' light in the medium are smoothed over some four pixels.
    bool soft_edges = false;
    float merge = 1; // pixels, 0...8: particles of a large medium that share a cell of at most that size become one
    bool shared_order = true; // isv, sphere, tiles: a head's two eyes are sorted for once, from the middle between them
    std::string scattering =
        "single"; // single | octaves | propagation: how often light may scatter, and by which model
    float exposure = 1;
    std::string tone_map = "filmic"; // filmic | linear
    uint32_t shadow_size = kAuto;    // volumetric shadow map: texels a side; auto: from the medium and shadow_error
    uint32_t shadow_slices = kAuto;  // its planes, 2...128; auto: the same
    // What it holds: sums, the depth before each place; fronts, whole particles, each from the plane behind its front.
    std::string shadow_map = "sums";
    float shadow_extent = kAuto;        // m, of its sides, around the camera's target; auto: what holds the medium
    float shadow_error = 3e-3f;         // relative error of the light in the medium, where the map's size is automatic
    uint32_t opaque_shadow_size = 1024; // texels a side
    float cutoff = 5e-2f;               // optical depth: bound on the SUM that proxies leave out on any ray

    bool operator==(const RenderSettings&) const = default;
};

} // namespace brume
