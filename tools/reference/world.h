// World: the input of the reference renderer, in double: media, lights, opaque objects, sky. Metres, radians, linear
// radiance.
#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "common/phase_lobes.h"
#include "common/scene.h"
#include "common/volume/volume.h"
#include "shaders/shared/emission.h"
#include "shaders/shared/types.h"

namespace brume::reference {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kSqrtPi = 1.77245385090551602730;
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A point on the ray is origin + t * direction, t in m; `direction` is unit.
struct Ray {
    glm::dvec3 origin, direction;
    double begin = 0, end = kInfinity;
    // Steps to the rays of the pixels to the right and below: m per m of distance, of parallel rays m. 0: of no pixel.
    glm::dvec3 right{0}, down{0};
    bool parallel = false;
    bool even = false; // True: planes are seen without their structure
    glm::dvec3 at(double t) const { return origin + t * direction; }
};

struct Interval {
    double begin, end;
    bool empty() const { return !(end > begin); }
};

// A Gaussian particle: extinction = sigma_t exp(-k^2 r^2).
struct Blob {
    glm::dvec3 centre; // m
    double scale;      // m, centre to vertex of its tetrahedron
    double k;          // 1/m
    double sigma_t;    // 1/m at the centre
    double half_line;  // optical depth from the centre outward
    glm::dvec3 albedo;
};
std::vector<Blob> blobsOf(std::span<const gpu::Particle> particles, double falloff);

// Semi-axes of a particle that is no ball (shaders/shared/ellipsoid.h). Its Blob's k and half_line are of the longest.
struct SemiAxes {
    glm::dvec3 a, b, c;
};
std::vector<SemiAxes> semiAxesOf(std::span<const gpu::EllipsoidAxes> axes);

// A particle on a line from `origin` along the unit `direction`.
struct BlobOnLine {
    double closest;   // m along the line, of the closest approach
    double b2;        // m^2, squared distance there
    double k;         // 1/m, along the line
    double half_line; // optical depth from the closest approach outward, if the line met the centre
};
// `axes`: the particle's; null: it is a ball.
BlobOnLine onLine(const Blob& blob, const SemiAxes* axes, glm::dvec3 origin, glm::dvec3 direction);

enum class Support { full, tetrahedron };
enum class Composition {
    overlapping, // the true medium: extinctions add up
    sequential,  // particles integrated one by one, composited by distance of their centres
};

// The medium of seed 003: constant extinction wherever there is at least one ball; overlaps do not add up. The seed
// gives no numbers. Its extinction is "user defined", one for the whole medium. Its radius is that of a particle's
// icosahedron, here a ball.
struct UnionMedium {
    struct Ball {
        glm::dvec3 centre;
        double radius; // m
    };
    std::vector<Ball> balls;
    double sigma_t = 0; // 1/m
    glm::dvec3 albedo{1};
};
// A medium in which each particle is a ball of radius `radius_per_scale` times its scale.
UnionMedium unionOf(std::span<const gpu::Particle> particles, double radius_per_scale, double sigma_t,
                    glm::dvec3 albedo);

// Tetrahedra: extinction and albedo are linear within each, between its corners. Where they overlap, extinctions add
// up.
struct TetrahedralMedium {
    struct Corner {
        glm::dvec3 place; // m
        double sigma_t;   // 1/m
        glm::dvec3 albedo;
    };
    std::vector<Corner> corners;
    std::vector<glm::uvec4> cells; // of each tetrahedron: indices of corners
};
TetrahedralMedium tetrahedraOf(std::span<const gpu::Particle> particles, std::span<const glm::uvec4> cells);

// Extinction at voxels, trilinear in between, 0 beyond the outermost.
struct VoxelMedium {
    std::shared_ptr<const Volume> volume; // null: there is none
    glm::dvec3 origin{0};                 // m, of the middle of voxel (0, 0, 0)
    double times = 1;                     // that the voxels' extinction is multiplied by
    glm::dvec3 albedo{1};
};

// extinction = sigma_t e^(-falloff (y - base)) where lo <= y <= hi and |x - centre| <= radius.
struct Fog {
    double sigma_t = 0; // 1/m at y = base
    glm::dvec3 albedo{1};
    double falloff = 0;                     // 1/m; 0: homogeneous
    double lo = -kInfinity, hi = kInfinity; // m
    glm::dvec3 centre{0};
    double radius = kInfinity; // m
    double base = 0;           // m
    PhaseLobes phase;
    glm::dvec3 emission{0};          // radiance; the fog emits (1 - albedo) * emission * extinction per metre
    glm::dvec3 extinction_colour{1}; // parts of the extinction for red, green and blue, in [0, 1]
};

struct LightSource {
    enum class Kind { directional, point, spot };
    Kind kind = Kind::directional;
    glm::dvec3 colour{1};                // directional: irradiance E, W/m^2; others: intensity I, W/sr
    glm::dvec3 to_light{0, 1, 0};        // directional: unit
    glm::dvec3 position{0};              // point, spot
    glm::dvec3 axis{0, -1, 0};           // spot: unit, along the light's travel
    double cos_outer = 0, cos_inner = 1; // spot: I * smoothstep(cos_outer, cos_inner, cosine to the axis)
    double radius = 0;                   // point, spot, m: I / (d^2 + radius^2)
    double range = kInfinity;            // point, spot, m: where its light ends, by (1 - (d / range)^4)^2
    bool shadows = true;                 // point, spot. True: all but fog shadows it; fog always dims it
};

struct Obstacle {
    enum class Kind { plane, box, sphere, triangle }; // a plane is horizontal ground, seen from above
    Kind kind = Kind::plane;
    glm::dvec3 centre{0};    // of a plane: only y counts
    glm::dvec3 half_size{1}; // of a sphere: x is the radius
    double yaw = 0;          // of a box, about +Y
    glm::dvec3 albedo{0.5};
    glm::dvec3 corners[3]{}; // of a triangle, which is opaque from both sides
    // Of a triangle: the third corner of the one other triangle at the edge from corner i to the next. Without one,
    // every shadow of the triangle ends at the edge.
    std::optional<glm::dvec3> beyond[3]{};
    double structure = 0, structure_size = 1; // of a plane: shaders/shared/ground.h
};
// Albedo where the ray meets the obstacle, `t` away: of a plane with structure the mean over the ray's pixel.
glm::dvec3 albedoAt(const Obstacle& obstacle, const Ray& ray, double t);
// The triangles of meshes.
std::vector<Obstacle> obstaclesOf(std::span<const Triangle> triangles);

// A thin flat sheet of glass (shaders/shared/glass.h). View rays are dimmed and mirrored by it. Light that scatters, or
// comes to a surface, passes as if there was none.
struct Sheet {
    glm::dvec3 centre{0};                       // m
    glm::dvec3 across{1, 0, 0}, along{0, 1, 0}; // unit / half of its width and height: 1/m
    glm::dvec3 normal{0, 0, 1};                 // unit
    glm::dvec3 transmittance{1};                // of what it does not mirror
    double reflectance = 0;                     // straight on
};
Sheet sheetOf(const Glass& glass);

struct World {
    std::vector<Blob> blobs;
    std::vector<SemiAxes> axes;                         // of each blob; empty: all are balls
    Support support = Support::full;                    // of the blobs along view rays
    bool cut_light = false;                             // True, with Support::tetrahedron: light depth is cut, too
    Composition composition = Composition::overlapping; // sequential: only worlds of blobs
    UnionMedium balls;
    TetrahedralMedium tetrahedra;
    VoxelMedium voxels;
    std::vector<Fog> fogs;
    std::vector<LightSource> lights;
    std::vector<Obstacle> obstacles;
    std::vector<Sheet> sheets;
    glm::dvec3 sky_zenith{0}, sky_horizon{0}; // radiance
    double haze = 0;                          // 1/m; throughHaze()
    glm::dvec3 ambient{0};                    // radiance from all directions, unshadowed
    glm::dvec3 emission{0}, cold_albedo{1};   // emittedBy()
    PhaseLobes phase;                         // of everything but fogs, which have their own
    glm::dvec3 extinction_colour{1};          // of everything but fogs: as theirs
    bool sky_lights = false;                  // True: what scatters gets the sky's light; only track() draws it
    bool onto_surfaces = false;               // True: surfaces get the medium's light; only track() draws it
};
// Radiance that everything but fogs emits per optical depth, where it has this albedo.
inline glm::dvec3 emittedBy(const World& world, glm::dvec3 albedo) {
    return physics::emitted<double>(world.emission, world.cold_albedo, 1, albedo);
}
// True: the extinction of some medium differs among red, green and blue.
bool isColoured(const World& world);
// Semi-axes of blob `i`; null: it is a ball.
inline const SemiAxes* axesOf(const World& world, size_t i) { return world.axes.empty() ? nullptr : &world.axes[i]; }
// The world as one channel (0, 1, 2: red, green, blue) sees it: not coloured.
World inChannel(const World& world, int channel);

// The parts of a scene that commands and time change, as they are now (Simulation::now()). `light`: the directional
// one.
struct Present {
    const brume::Medium& medium;
    const brume::Light& light;
    std::span<const brume::Light> local_lights;
    std::span<const brume::Fog> fogs;
    std::span<const gpu::EllipsoidAxes> axes = {}; // Simulation::axes()
};
// The world of a scene as the server renders it.
World worldOf(const Scene& scene, std::span<const gpu::Particle> particles, const Present& now);
// The world of a scene at its start.
World worldOf(const Scene& scene, std::span<const gpu::Particle> particles);

LightSource directional(const brume::Light& light);
LightSource localLight(const brume::Light& light);
Fog fogOf(const brume::Fog& fog);

// Phase function, 1/sr, of unit directions of propagation. Henyey-Greenstein without cancellation: |in - out|^2 in
// place of 2 - 2 cos.
double phase(const PhaseLobes& lobes, glm::dvec3 travel_in, glm::dvec3 travel_out);

// Radiance of the sky: blends from the horizon's to the zenith's as the height of the unit direction goes from -0.15
// to 0.85.
glm::dvec3 skyRadiance(const World& world, glm::dvec3 direction);
// Radiance of a surface that is seen along the unit `direction`, `distance` away: clear air of extinction `haze`
// between, which has the sky's radiance there.
glm::dvec3 throughHaze(const World& world, glm::dvec3 surface, double distance, glm::dvec3 direction);

} // namespace brume::reference
