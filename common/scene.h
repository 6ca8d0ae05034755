// A scene as loaded from TOML: plain numbers, already checked. Metres, seconds, radians, linear Rec.709.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace brume {

struct Range {
    float lo = 0, hi = 0;
};

enum class Layout { cube, tubes, cumulus, emitter, file, sequence, live, none };

// Births per second from a disc; every particle rises, grows, thins (its optical mass is conserved) and dies at its
// life's end.
struct Emitter {
    glm::vec3 position{0};
    float radius = 0.5f;         // m, of the disc that births fall on
    float rate = 500;            // 1/s
    float life = 8;              // s
    glm::vec3 velocity{0, 2, 0}; // m/s at birth
    float spread = 0.3f;         // m/s, random part of the velocity at birth
    float growth = 0.3f;         // m/s, d(scale)/dt
    float buoyancy = 0.5f;       // m/s^2 along +Y, fading over the life
    glm::vec3 wind{0};           // m/s that velocities relax to
    float turbulence = 0.8f;     // m/s, RMS of the divergence-free noise velocity
    float eddy = 3;              // m, size of the largest eddies
};

// A phase function: mixture (1-a)/4pi + a HG(g), double (1-a) HG(h) + a HG(g), rayleigh, or droplets of water.
struct PhaseSettings {
    std::string phase = "mixture";
    float anisotropy = 0;       // a in [0, 1]; mixture, double
    float asymmetry = 0;        // g in (-1, 1); mixture, double
    float second_asymmetry = 0; // h in (-1, 1); double
    float droplet = 20;         // micrometres, diameter, 5 ... 50; droplets
};

inline constexpr const char *kSumMedium = "sum", *kUnionMedium = "union";

struct Medium : PhaseSettings {
    Layout layout = Layout::cube;
    // sum: particles are Gaussians, and their extinctions add up. union: they are balls, and the extinction is the same
    // wherever at least one of them is (Mattsson 2022).
    std::string model = kSumMedium;
    float union_radius = 0.12f;   // radius of a ball, per scale
    float union_extinction = 0.5; // 1/m
    uint32_t count = 500;         // 1 ... 1,000,000; an emitter's pool size; rows of layout live
    glm::vec3 centre{0};          // m, of the layout; with layouts file, sequence and live what points are moved by
    float extent = 10;            // m, side of the cube, length of a tube, width of the cumulus
    Range scale{6, 6};            // m, centre to vertex of a particle's tetrahedron, uniform or by the layout
    // True: the scene gives no extinction, and points of a file without one get that of a mean optical depth of 3.
    bool extinction_by_depth = false;
    // True: the scene gives no scale, and points of files without sizes have one that follows from their spacing.
    bool scale_by_spacing = false;
    float falloff = 1.6f;           // f: u = scale * f, extinction = peak * exp(-50 r^2 / u^2)
    float extinction = 15;          // sigma_t at a particle's centre = extinction * multiplier * 1e-4 (1/m)
    Range multiplier{5, 10};        // per particle, uniform
    glm::vec3 albedo{0.9f};         // rho, in [0, 1]
    glm::vec3 extinction_colour{1}; // in [0, 1]: extinctionParts()
    uint64_t seed = 1;
    Emitter emitter; // layout emitter only
    // Layouts file and sequence only, resolved against the scene's folder. Of a sequence its name has a run of #, each
    // a digit.
    std::filesystem::path file;
    // For render.sprites.maps = "files": the two PNG files SPRITE_MAPS-positive.png and SPRITE_MAPS-negative.png,
    // resolved against the scene's folder.
    std::filesystem::path sprite_maps;
    float rate = 24;  // 1/s, how many numbers of files pass; layout sequence only
    bool loop = true; // True: after the last file comes the first; false: the last one stays. Layout sequence only
};

// A medium without particles: extinction * e^(-falloff (y - height)) between two heights and within a ball.
struct Fog : PhaseSettings {
    float extinction = 0.02f;       // 1/m, at `height`; 0: there is no fog
    float height = 0;               // m
    float falloff = 0;              // 1/m; 0: homogeneous
    float lo = -5e4f, hi = 5e4f;    // m, heights where it begins and ends; the ends of limits::kPlace: nowhere
    glm::vec3 centre{0};            // m, of the ball
    float radius = 0;               // m, of the ball; 0: there is none
    glm::vec3 albedo{0.9f};         // in [0, 1]
    glm::vec3 emission{0};          // W/(m^2 sr): fog that nothing is seen through emits (1 - albedo) * emission
    glm::vec3 extinction_colour{1}; // in [0, 1]: extinctionParts()
};

// Extinction of red, green and blue as parts of the medium's: only the ratios of its colour count. Black is as white.
inline glm::vec3 extinctionParts(glm::vec3 colour) {
    const float most = glm::max(colour.x, glm::max(colour.y, colour.z));
    return most > 0 ? colour / most : glm::vec3(1);
}

struct SimulationSettings {
    float spring = 4;             // 1/s^2, acceleration toward the target per metre
    float viscosity = 1.5f;       // 1/s
    float impulse_radius = 2;     // m around the cursor's ray
    float impulse_strength = 8;   // m/s at the ray
    glm::vec3 volume_velocity{0}; // m/s, the volume drifts
    float volume_swing = 0;       // m, amplitude along x of a slow sway
    float volume_period = 10;     // s, of that sway
    bool paused = false;
};

inline constexpr const char *kDirectional = "directional", *kPoint = "point", *kSpot = "spot";

// A light. A local one, a point or a spot, sends intensity / (d^2 + radius^2) to a place d metres away: without a
// radius that is the inverse square law. With a range the light ends there, by the factor (1 - (d / range)^4)^2.
struct Light {
    std::string type = kDirectional;
    // Directional.
    glm::vec3 to_light{0.4f, 0.8f, 0.45f}; // unit after loading
    glm::vec3 irradiance{10};              // E, W/m^2 per channel, perpendicular to the light
    float rotate = 0;                      // rad/s about +Y
    // Point and spot.
    glm::vec3 position{0, 3, 0};
    glm::vec3 intensity{100}; // I, W/sr per channel; of a spot within its inner cone
    float range = 0;          // m; 0: without end
    float radius = 0;         // m
    bool shadows = true;      // True: objects and the medium's particles shadow it
    float orbit = 0;          // rad/s about the vertical through `pivot`
    glm::vec3 pivot{0};
    // Spot: smoothstep of the cosine from the outer cone to the inner one.
    glm::vec3 axis{0, -1, 0};         // unit after loading, the way that the light goes
    float inner = 0.3f, outer = 0.5f; // rad between the axis and the cone
};
inline bool isLocal(const Light& light) { return light.type != kDirectional; }

struct Plane { // horizontal ground, seen from above
    float height = 0;
    glm::vec3 albedo{0.5f};
    float structure = 0;      // in [0, 1]: the albedo varies by up to this part of it (shaders/shared/ground.h)
    float structure_size = 5; // m, length of the longest waves of the structure

    bool operator==(const Plane&) const = default;
};
struct Box {
    glm::vec3 centre{0}, size{1}; // m, full edge lengths
    float yaw = 0;                // rad about +Y
    glm::vec3 albedo{0.5f};

    bool operator==(const Box&) const = default;
};
struct Sphere {
    glm::vec3 centre{0};
    float radius = 1;
    glm::vec3 albedo{0.5f};

    bool operator==(const Sphere&) const = default;
};

// Triangles of a glTF file: an opaque object that is seen, lit and throws shadows from both sides.
struct Mesh {
    std::filesystem::path file; // .glb or .gltf, resolved against the scene's folder
    glm::vec3 position{0};      // m, where the file's origin is
    float scale = 1;            // m per unit of the file
    float yaw = 0;              // rad about +Y
};
struct Triangle {
    glm::vec3 corners[3]; // m
    glm::vec3 albedo;
};

inline constexpr const char *kNoObjects = "none", *kCourtyard = "courtyard", *kStreet = "street", *kIslands = "islands",
                            *kAtrium = "atrium";

// Many boxes and spheres in place of a list of them (common/object_layout.h).
struct ObjectLayout {
    std::string layout = kNoObjects;
    uint32_t count = 1000; // boxes and spheres together, 1 ... limits::kObjects
    uint64_t seed = 1;
    glm::vec3 centre{0}; // m, the middle of its ground
};

struct Sky {
    glm::vec3 zenith{0.18f, 0.32f, 0.62f}; // radiance straight up; blends to the horizon's
    glm::vec3 horizon{0.55f, 0.66f, 0.78f};
    glm::vec3 ambient{
        0};         // uniform radiance that the medium scatters in without shadowing; exact: rho * ambient * (1 - T)
    float haze = 0; // 1/m; extinction of clear air in front of surfaces, which fade to the sky
};

struct SceneCamera {
    glm::vec3 position{0, 2, 26}, target{0};
    float fov_y = 0.8f;
};

// A number that the server chooses: "auto" in a scene.
inline constexpr uint32_t kAuto = 0;

// Settings of one method each: [render.NAME] in a scene.
struct IsvSettings {
    std::string quadrature = "simpson"; // simpson | transmittance | analytic
    uint32_t steps = 2;                 // simpson 1...10, transmittance 1...3

    bool operator==(const IsvSettings&) const = default;
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
    float far = kAuto;           // m of view depth, where slices end; auto: where the medium does
    bool jitter = false;         // froxels. True: each tick's samples lie elsewhere within their slices
    float history = 0;           // froxels: part of a cell's light that is kept from an eye's last picture, up to 0.98
    std::string shadows = "ray"; // froxels: how objects shadow the medium: map | ray | grid | hybrid

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
// With shadows = "hybrid": light past objects in coarse froxels before each eye; behind them the grid is read.
struct ShadowFrustumSettings {
    uint32_t pixels = 16; // 1...64
    float part = 0.333f;  // part of the slices that it covers, from the eye on

    bool operator==(const ShadowFrustumSettings&) const = default;
};
// Method lit: extinction and light at nodes of world space.
struct LitSettings {
    float spacing = kAuto; // m between nodes; auto: as the medium's particles need, or 1/96 of what they cover

    bool operator==(const LitSettings&) const = default;
};

// Method gradients: light is computed at few places, and interpolated to the nodes that method lit reads.
struct RadianceSettings {
    // exact: computed at every node. rbf, gradient: at samples in spheres, without and with their gradients (Ren et al.
    // 2008). nested: at every fourth node, and between these where interpolation errs.
    std::string interpolation = "nested";
    std::string quantity = "factor";  // radiance | factor: what is interpolated; the factor is the part that arrives
    std::string weights = "gaussian"; // printed | gaussian: how samples in spheres are weighted
    float error = 0.02f;              // a sample that errs by more is split: a part of all light, times opacity
    uint32_t levels = 3;              // number of grids that samples are split into, 0...3
    float spacing = kAuto;            // m between nodes, as LitSettings::spacing
    float gradient_step = 1;          // spacings between a sample and those for its differences
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
    float opacity = kAuto;      // mean over a ball's disc; auto: that of the ball's mean chord
    float size = 1.3f;          // half a picture's side, in radii of its ball

    bool operator==(const SpritesSettings&) const = default;
};
// Method march: samples along every pixel's ray, dithered and blurred.
struct MarchSettings {
    uint32_t samples = 8;          // 1...256
    std::string dither = "bayer8"; // none | white | bayer4 | bayer8 | ign | blue
    std::string jitter = "offset"; // offset | stratified | opacity
    std::string blur = "row14";    // none | row14 | printed | box8
    float depth_falloff = 3;       // m, of view depth: over which the blur's weights fall to 0

    bool operator==(const MarchSettings&) const = default;
};

struct MethodSettings {
    IsvSettings isv;
    TilesSettings tiles;
    GridSettings grid;
    FroxelSettings froxels;
    ShadowGridSettings shadow_grid;
    ShadowFrustumSettings shadow_frustum;
    LitSettings lit;
    RadianceSettings radiance;
    PathSettings path;
    SpritesSettings sprites;
    MarchSettings march;

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
    float merge = 1; // pixels, 0...8: particles of a large medium that share a cell of at most that size become one
    bool shared_order = true; // isv, sphere, tiles: a head's two eyes are sorted for once, from the middle between them
    float exposure = 1;
    std::string tone_map = "filmic";    // filmic | linear
    uint32_t shadow_size = kAuto;       // volumetric shadow map: texels a side; auto: from the medium and shadow_error
    uint32_t shadow_slices = kAuto;     // its planes, 2...128; auto: the same
    float shadow_error = 3e-3f;         // relative error of the light in the medium, where the map's size is automatic
    uint32_t opaque_shadow_size = 1024; // texels a side
    float cutoff = 5e-2f;               // optical depth: bound on the SUM that proxies leave out on any ray
};

struct Scene {
    std::string name;
    // World coordinates (m) of the point that all places here count from. Places in the file and in its point cloud are
    // world coordinates; the origin is subtracted from them in double, so that scenes far from zero lose nothing in
    // float32. A place that the file leaves out is the default, counted from the origin.
    glm::dvec3 origin{0};
    Medium medium;
    SimulationSettings simulation;
    std::vector<Light> lights; // at most one that is directional, and limits::kLocalLights others
    std::vector<Fog> fogs;     // at most limits::kFogs
    std::vector<Plane> planes;
    ObjectLayout objects;
    std::vector<Box> boxes; // of the file, then those of `objects`
    std::vector<Sphere> spheres;
    std::vector<Mesh> meshes;
    std::vector<Triangle> triangles;                   // of `meshes`, at most limits::kTriangles
    uint32_t laid_out_boxes = 0, laid_out_spheres = 0; // how many of them are of `objects`
    Sky sky;
    SceneCamera camera;
    bool camera_by_points = false; // True: the scene has points of a file and gives no camera: placeCamera() does
    RenderSettings render;
};

// The directional light. A scene without one has one of irradiance 0 here, which commands can turn on.
inline Light sunOf(const Scene& scene) {
    for (const Light& light : scene.lights)
        if (!isLocal(light)) return light;
    return {.to_light = {0, 1, 0}, .irradiance = glm::vec3(0)};
}
inline std::vector<Light> localLightsOf(const Scene& scene) {
    std::vector<Light> local;
    for (const Light& light : scene.lights)
        if (isLocal(light)) local.push_back(light);
    return local;
}

// What is wrong with a scene: "file:line: key: what, and what is allowed".
struct SceneError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Strict: an unknown key, a wrong type or a value out of range throws SceneError. Missing keys take the defaults above.
// `overrides` are settings that replace the file's, as on a command line: "medium.count=5000", "render.method=isv"; of
// lists of tables ("light.irradiance=[1,1,1]") they replace the setting in every element.
Scene loadScene(const std::filesystem::path& file, std::span<const std::string> overrides = {});

// Names of the scenes in a folder, in order; none if it cannot be read.
std::vector<std::string> sceneNames(const std::filesystem::path& folder);
// A name ("plume") is looked up in `scene_dir`; anything with a slash or ".toml" is a path.
std::filesystem::path findScene(const std::string& name_or_path, const std::filesystem::path& scene_dir);

} // namespace brume
