#include "tools/reference/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "common/scene_limits.h"
#include "common/tetrahedra.h"
#include "shaders/shared/ellipsoid.h"
#include "shaders/shared/ground.h"
#include "shaders/shared/sky.h"

namespace brume::reference {

std::vector<Blob> blobsOf(std::span<const gpu::Particle> particles, double falloff) {
    std::vector<Blob> blobs;
    blobs.reserve(particles.size());
    for (const gpu::Particle& p : particles) {
        const double k = std::sqrt(50.0) / (p.scale * falloff);
        blobs.push_back({p.centre, p.scale, k, p.sigma_t, p.sigma_t * kSqrtPi / (2 * k), p.albedo});
    }
    return blobs;
}

std::vector<SemiAxes> semiAxesOf(std::span<const gpu::EllipsoidAxes> axes) {
    std::vector<SemiAxes> out;
    out.reserve(axes.size());
    for (const gpu::EllipsoidAxes& one : axes) out.push_back({one.a, one.b, one.c});
    return out;
}

BlobOnLine onLine(const Blob& blob, const SemiAxes* axes, glm::dvec3 origin, glm::dvec3 direction) {
    const glm::dvec3 to = blob.centre - origin;
    if (!axes) {
        const double closest = glm::dot(to, direction);
        const glm::dvec3 off = to - closest * direction;
        return {closest, glm::dot(off, off), blob.k, blob.half_line};
    }
    const auto ball = physics::ballOnLine(to, direction, blob.k, axes->a, axes->b, axes->c);
    return {ball.closest, ball.b2, ball.k, blob.half_line * blob.k / ball.k};
}

UnionMedium unionOf(std::span<const gpu::Particle> particles, double radius_per_scale, double sigma_t,
                    glm::dvec3 albedo) {
    UnionMedium medium{{}, sigma_t, albedo};
    for (const gpu::Particle& p : particles) medium.balls.push_back({p.centre, radius_per_scale * p.scale});
    return medium;
}

TetrahedralMedium tetrahedraOf(std::span<const gpu::Particle> particles, std::span<const glm::uvec4> cells) {
    TetrahedralMedium medium{{}, {cells.begin(), cells.end()}};
    for (const gpu::Particle& p : particles) medium.corners.push_back({p.centre, p.sigma_t, p.albedo});
    return medium;
}

std::vector<Obstacle> obstaclesOf(std::span<const Triangle> triangles) {
    using Place = std::array<float, 3>;
    struct Side {
        size_t triangle, edge;
    };
    std::map<std::array<Place, 2>, std::vector<Side>> edges;
    std::vector<Obstacle> out;
    for (const Triangle& from : triangles) {
        Obstacle& to = out.emplace_back();
        to.kind = Obstacle::Kind::triangle;
        to.albedo = from.albedo;
        std::array<Place, 3> places;
        for (size_t i = 0; i < 3; ++i) {
            to.corners[i] = from.corners[i];
            places[i] = {from.corners[i].x, from.corners[i].y, from.corners[i].z};
        }
        for (size_t i = 0; i < 3; ++i) {
            const auto [lo, hi] = std::minmax(places[i], places[(i + 1) % 3]);
            edges[{lo, hi}].push_back({out.size() - 1, i});
        }
    }
    for (const auto& [places, sides] : edges) {
        if (sides.size() != 2) continue;
        for (const size_t i : {0, 1}) {
            const Side here = sides[i], there = sides[1 - i];
            out[here.triangle].beyond[here.edge] = out[there.triangle].corners[(there.edge + 2) % 3];
        }
    }
    return out;
}

glm::dvec3 albedoAt(const Obstacle& obstacle, const Ray& ray, double t) {
    if (!(obstacle.structure > 0) || ray.even) return obstacle.albedo;
    const glm::dvec3 x = ray.at(t);
    const double depth = ray.parallel ? 1 : t;
    const double mean =
        physics::groundStructure(x.x, x.z, physics::groundFootprint(ray.direction, ray.right, depth),
                                 physics::groundFootprint(ray.direction, ray.down, depth), obstacle.structure_size);
    return physics::groundAlbedo(obstacle.albedo, obstacle.structure, mean);
}

Sheet sheetOf(const Glass& glass) {
    const double yaw = double(glass.yaw), pitch = double(glass.pitch);
    const glm::dvec3 forward(std::sin(yaw), 0, std::cos(yaw)), up(0, 1, 0);
    return {.centre = glass.centre,
            .across = glm::dvec3(std::cos(yaw), 0, -std::sin(yaw)) * (2 / double(glass.width)),
            .along = (std::cos(pitch) * up + std::sin(pitch) * forward) * (2 / double(glass.height)),
            .normal = std::cos(pitch) * forward - std::sin(pitch) * up,
            .transmittance = glass.transmittance,
            .reflectance = double(glass.reflectance)};
}

LightSource directional(const brume::Light& light) {
    LightSource source;
    source.colour = light.irradiance;
    source.to_light = glm::normalize(glm::dvec3(light.to_light));
    return source;
}

LightSource localLight(const brume::Light& light) {
    LightSource source;
    source.kind = light.type == kSpot ? LightSource::Kind::spot : LightSource::Kind::point;
    source.colour = light.intensity;
    source.position = light.position;
    source.axis = glm::normalize(glm::dvec3(light.axis));
    source.cos_outer = std::cos(double(light.outer));
    source.cos_inner = std::cos(double(light.inner));
    source.radius = double(light.radius);
    if (light.range > 0) source.range = double(light.range);
    source.shadows = light.shadows;
    return source;
}

Fog fogOf(const brume::Fog& fog) {
    Fog out{.sigma_t = double(fog.extinction), .albedo = fog.albedo, .falloff = double(fog.falloff)};
    if (fog.lo > limits::kPlace.lo) out.lo = double(fog.lo);
    if (fog.hi < limits::kPlace.hi) out.hi = double(fog.hi);
    out.centre = fog.centre;
    if (fog.radius > 0) out.radius = double(fog.radius);
    out.base = double(fog.height);
    out.phase = lobesOf(fog);
    out.emission = fog.emission;
    out.extinction_colour = extinctionParts(fog.extinction_colour);
    return out;
}

bool isColoured(const World& world) {
    const auto coloured = [](glm::dvec3 colour) { return colour != glm::dvec3(1); };
    return coloured(world.extinction_colour) || std::ranges::any_of(world.fogs, coloured, &Fog::extinction_colour);
}

World inChannel(const World& world, int channel) {
    World one = world;
    const double part = world.extinction_colour[channel];
    for (Blob& blob : one.blobs) blob.sigma_t *= part, blob.half_line *= part;
    one.balls.sigma_t *= part;
    one.voxels.times *= part;
    for (TetrahedralMedium::Corner& corner : one.tetrahedra.corners) corner.sigma_t *= part;
    one.extinction_colour = glm::dvec3(1);
    for (Fog& fog : one.fogs) {
        fog.sigma_t *= fog.extinction_colour[channel];
        fog.extinction_colour = glm::dvec3(1);
    }
    return one;
}

World worldOf(const Scene& scene, std::span<const gpu::Particle> particles, const Present& now) {
    World world;
    if (now.medium.model == kUnionMedium)
        world.balls =
            unionOf(particles, double(now.medium.union_radius), double(now.medium.union_extinction), now.medium.albedo);
    else if (now.medium.model == kTetrahedraMedium)
        world.tetrahedra = tetrahedraOf(particles, scene.tetrahedra->corners);
    else if (scene.volume)
        world.voxels = {scene.volume, scene.volume->origin + glm::dvec3(now.medium.centre),
                        scene.medium.extinction > 0 ? double(now.medium.extinction / scene.medium.extinction) : 1,
                        now.medium.albedo};
    else
        world.blobs = blobsOf(particles, now.medium.falloff), world.axes = semiAxesOf(now.axes);
    world.lights = {directional(now.light)};
    for (const brume::Light& light : now.local_lights) world.lights.push_back(localLight(light));
    for (const brume::Fog& fog : now.fogs)
        if (fog.extinction > 0) world.fogs.push_back(fogOf(fog));
    for (const Plane& p : scene.planes) {
        world.obstacles.push_back({Obstacle::Kind::plane, {0, p.height, 0}, glm::dvec3(0), 0, p.albedo});
        world.obstacles.back().structure = double(p.structure);
        world.obstacles.back().structure_size = double(p.structure_size);
    }
    for (const Box& b : scene.boxes)
        world.obstacles.push_back({Obstacle::Kind::box, b.centre, glm::dvec3(b.size) * 0.5, b.yaw, b.albedo});
    for (const Sphere& s : scene.spheres)
        world.obstacles.push_back({Obstacle::Kind::sphere, s.centre, glm::dvec3(s.radius), 0, s.albedo});
    for (const Obstacle& triangle : obstaclesOf(scene.triangles)) world.obstacles.push_back(triangle);
    for (const Glass& glass : scene.glasses) world.sheets.push_back(sheetOf(glass));
    world.sky_zenith = scene.sky.zenith;
    world.sky_horizon = scene.sky.horizon;
    world.haze = double(scene.sky.haze);
    world.ambient = scene.sky.ambient;
    const auto [emission, cold_albedo] = sootOf(now.medium);
    world.emission = emission, world.cold_albedo = cold_albedo;
    world.sky_lights = scene.sky.lights;
    world.onto_surfaces = scene.render.propagation.onto_surfaces;
    world.phase = lobesOf(now.medium);
    world.extinction_colour = extinctionParts(now.medium.extinction_colour);
    return world;
}

World worldOf(const Scene& scene, std::span<const gpu::Particle> particles) {
    const std::vector<brume::Light> local_lights = localLightsOf(scene);
    const brume::Light sun = sunOf(scene);
    return worldOf(scene, particles, {scene.medium, sun, local_lights, scene.fogs});
}

double phase(const PhaseLobes& lobes, glm::dvec3 travel_in, glm::dvec3 travel_out) {
    const auto& [part, asymmetry, draine, second] = lobes;
    const auto henyeyGreenstein = [&](double g) {
        const double size = std::abs(g);
        const glm::dvec3 apart = g < 0 ? travel_in + travel_out : travel_in - travel_out;
        const double d = (1 - size) * (1 - size) + size * glm::dot(apart, apart);
        return (1 - size) * (1 + size) / (4 * kPi * d * std::sqrt(d));
    };
    const double cosine = glm::dot(travel_in, travel_out);
    const double wide =
        (1 + draine * cosine * cosine) / (1 + draine * (1 + 2 * asymmetry * asymmetry) / 3); // Draine over HG
    return (1 - part) * henyeyGreenstein(second) + part * henyeyGreenstein(asymmetry) * wide;
}

glm::dvec3 throughHaze(const World& world, glm::dvec3 surface, double distance, glm::dvec3 direction) {
    return glm::mix(skyRadiance(world, direction), surface, std::exp(-world.haze * distance));
}

glm::dvec3 skyRadiance(const World& world, glm::dvec3 direction) {
    return glm::mix(world.sky_horizon, world.sky_zenith, physics::skyZenithPart(direction.y));
}

} // namespace brume::reference
