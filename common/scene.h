// A scene as loaded from TOML: plain numbers, already checked. Metres, seconds, radians, linear Rec.709.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "common/camera_keys.h"
#include "common/render_settings.h"

namespace brume {

struct Range {
    float lo = 0, hi = 0;
};

enum class Layout { cube, tubes, cumulus, emitter, file, sequence, volume, live, none };
// True: what there is comes from files.
inline bool isFromFiles(Layout layout) {
    return layout == Layout::file || layout == Layout::sequence || layout == Layout::volume;
}

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
    // The albedo at birth, of which every colour nears the medium's as e^(-age / cooling).
    glm::vec3 albedo{0};
    glm::vec3 cooling{0}; // s, of each colour; 0: all have the medium's albedo
};

// A phase function: mixture (1-a)/4pi + a HG(g), double (1-a) HG(h) + a HG(g), rayleigh, or droplets of water.
struct PhaseSettings {
    std::string phase = "mixture";
    float anisotropy = 0;       // a in [0, 1]; mixture, double
    float asymmetry = 0;        // g in (-1, 1); mixture, double
    float second_asymmetry = 0; // h in (-1, 1); double
    float droplet = 20;         // micrometres, diameter, 5 ... 50; droplets
};

inline constexpr const char *kSumMedium = "sum", *kEllipsoidMedium = "ellipsoids", *kUnionMedium = "union",
                            *kTetrahedraMedium = "tetrahedra", *kVolumeMedium = "volume";

struct Medium : PhaseSettings {
    Layout layout = Layout::cube;
    // sum: particles are Gaussians, and their extinctions add up. ellipsoids: so they are, with three axes each, which
    // come with the points of a file. union: they are balls, and the extinction is the same
    // wherever at least one of them is (Mattsson 2022). tetrahedra: they are the corners of the file's tetrahedra, and
    // the extinction is linear within each.
    std::string model = kSumMedium;
    float union_radius = 0.12f;   // radius of a ball, per scale
    float union_extinction = 0.5; // 1/m
    uint32_t count = 500;         // 1 ... 1,000,000; an emitter's pool size; rows of layout live
    glm::vec3 centre{0};          // m, of the layout; with layouts file, sequence and live what points are moved by
    float extent = 10;            // m, side of the cube, length of a tube, width of the cumulus
    Range scale{6, 6};            // m, centre to vertex of a particle's tetrahedron, uniform or by the layout
    // True: the scene gives no extinction, and points of a file without one get that of a mean optical depth of 3. Of a
    // sequence all get that of the first file.
    bool extinction_by_depth = false;
    // True: the scene gives no scale, and points of files without sizes have one that follows from their spacing.
    bool scale_by_spacing = false;
    float falloff = 1.6f;           // f: u = scale * f, extinction = peak * exp(-50 r^2 / u^2)
    float extinction = 15;          // sigma_t at a particle's centre = extinction * multiplier * 1e-4 (1/m)
    Range multiplier{5, 10};        // per particle, uniform
    glm::vec3 albedo{0.9f};         // rho, in [0, 1]
    glm::vec3 emission{0};          // W/(m^2 sr), of glowing soot: sootOf()
    glm::vec3 cold_albedo{1};       // of a drawing viewer's medium, as the server says; 1 in every other
    glm::vec3 extinction_colour{1}; // in [0, 1]: extinctionParts()
    uint64_t seed = 1;
    Emitter emitter; // layout emitter only
    // Layouts file and sequence only, resolved against the scene's folder. Of a sequence its name has a run of #, each
    // a digit.
    std::filesystem::path file;
    // How the files' places become the scene's (PlyFrame in common/ply/ply.h), and whether points that are far from all
    // others (PlyExtent) are left out or kept.
    float unit = 1; // m, of the files' lengths
    std::string up = "y", far_points = "keep";
    // For render.sprites.maps = "files": the two PNG files SPRITE_MAPS-positive.png and SPRITE_MAPS-negative.png,
    // resolved against the scene's folder.
    std::filesystem::path sprite_maps;
    float rate = 24;  // 1/s, how many numbers of files pass; layout sequence only
    bool loop = true; // True: after the last file comes the first; false: the last one stays. Layout sequence only
};

// Soot of a medium that is a mixture of it and of what is cold: what physics::emitted() takes.
struct Soot {
    glm::vec3 emission;    // W/(m^2 sr)
    glm::vec3 cold_albedo; // above 0
};
// In an emitter's plume cold smoke has the medium's albedo. Elsewhere that is 1: the more the medium absorbs the more
// it emits. A channel whose cold albedo is 0 emits nothing, since soot cannot be told from smoke by its albedo.
inline Soot sootOf(const Medium& medium) {
    Soot soot{medium.emission, medium.layout == Layout::emitter ? medium.albedo : medium.cold_albedo};
    for (int c = 0; c < 3; ++c)
        if (!(soot.cold_albedo[c] > 0)) soot.emission[c] = 0, soot.cold_albedo[c] = 1;
    return soot;
}

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
    bool collide = false;         // True: particles do not pass planes, boxes, spheres and meshes
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
    float rotate = 0;                      // rad/s about `rotate_axis`
    glm::vec3 rotate_axis{0, 1, 0};        // unit after loading
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
// A thin flat sheet that is seen through, upright where `pitch` is 0. It throws no shadow.
struct Glass {
    glm::vec3 centre{0};                        // m
    float width = 2, height = 2;                // m
    float yaw = 0, pitch = 0;                   // rad; at 0 it faces +Z. First it tips about +X, then it turns about +Y
    glm::vec3 transmittance{0.75f, 0.9f, 0.8f}; // part of each colour that passes, in [0, 1]
    float reflectance = 0.04f;                  // part of the sky's radiance that it mirrors, straight on, in [0, 1]

    bool operator==(const Glass&) const = default;
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
    bool lights = false; // True: it lights the medium, which dims and scatters its light
};

struct SceneCamera {
    glm::vec3 position{0, 2, 26}, target{0};
    float fov_y = 0.8f;
};

// True: fog, points and spots, and meshes may be in the medium: it is no union of balls, and not of tetrahedra.
inline bool isMixable(const Medium& medium) {
    return medium.model != kUnionMedium && medium.model != kTetrahedraMedium;
}

struct Tetrahedra; // common/tetrahedra.h
struct Volume;     // common/volume/volume.h

struct Scene {
    std::string name;
    // World coordinates (m) of the point that all places here count from. Places in the file and in its point cloud are
    // world coordinates; the origin is subtracted from them in double, so that scenes far from zero lose nothing in
    // float32. A place that the file leaves out is the default, counted from the origin.
    glm::dvec3 origin{0};
    Medium medium;
    std::shared_ptr<const Tetrahedra> tetrahedra; // of the medium's file; null with another model
    std::shared_ptr<const Volume> volume;         // of the medium's file; null with another layout
    SimulationSettings simulation;
    std::vector<Light> lights; // at most one that is directional, and limits::kLocalLights others
    std::vector<Fog> fogs;     // at most limits::kFogs
    std::vector<Plane> planes;
    ObjectLayout objects;
    std::vector<Box> boxes; // of the file, then those of `objects`
    std::vector<Sphere> spheres;
    std::vector<Mesh> meshes;
    std::vector<Glass> glasses;                        // at most limits::kGlasses
    std::vector<Triangle> triangles;                   // of `meshes`, at most limits::kTriangles
    uint32_t laid_out_boxes = 0, laid_out_spheres = 0; // how many of them are of `objects`
    Sky sky;
    SceneCamera camera;
    bool camera_by_points = false;      // True: the scene has points of a file and gives no camera: placeCamera() does
    std::vector<CameraKey> camera_keys; // at most limits::kCameraKeys
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
