#include "server/inputs/tick_block.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "common/ellipsoid.h"
#include "common/phase_lobes.h"
#include "common/scene_limits.h"
#include "server/inputs/multiple_block.h"
#include "server/inputs/scene_features.h"
#include "server/inputs/union_block.h"
#include "server/medium/shadow_resolution.h"
#include "shaders/shared/support.h"

namespace brume {
namespace {

// Optical depth that no single particle's proxy may leave out, however few there are: its rim would be seen.
constexpr float kMostCut = 1e-4f;
// And one that it may, however small the setting is: a Gaussian has no end.
constexpr float kLeastCut = 1e-12f;

// Part of a particle's mean optical depth that cut rims may take: 0.1 % of the light of a thin medium.
constexpr double kMostRim = 1e-3;

// Optical depth below which a particle's rim is left out.
float cutOf(std::span<const gpu::Particle> particles, float cutoff, float falloff) {
    double depths = 0, areas = 0; // sums of area * depth of the line through the centre, and of areas
    for (const gpu::Particle& p : particles) {
        const double u = double(p.scale) * double(falloff);
        depths += u * u * 0.25066282746310005 * double(p.sigma_t) * u, areas += u * u;
    }
    const auto rim = float(areas > 0 ? kMostRim * depths / areas : 0);
    const float each = cutoff / float(std::max<size_t>(particles.size(), 1));
    return std::clamp(std::min(each, rim), kLeastCut, kMostCut);
}

struct LightBounds {
    glm::vec3 lo{std::numeric_limits<float>::max()}, hi{std::numeric_limits<float>::lowest()};
    void add(glm::vec3 point, float radius) {
        lo = glm::min(lo, point - radius);
        hi = glm::max(hi, point + radius);
    }
    void fallback() { // nothing inside, or no extent to divide by
        if (!(lo.x <= hi.x)) lo = glm::vec3(-1), hi = glm::vec3(1);
        hi = glm::max(hi, lo + 1e-3f);
    }
};

glm::vec3 inLightSpace(const gpu::Tick& tick, glm::vec3 x) {
    return {glm::dot(tick.map.x, x), glm::dot(tick.map.y, x), glm::dot(tick.sun.to_light, x)};
}

// Of every particle's support, or of the corners of tetrahedra. Most particles lie so far inside that no radius of
// theirs can matter.
LightBounds mediumBounds(std::span<const gpu::Particle> particles, bool corners, const gpu::Tick& tick) {
    LightBounds bounds;
    if (corners) {
        for (const gpu::Particle& p : particles) bounds.add(inLightSpace(tick, p.centre), 0);
        bounds.fallback();
        return bounds;
    }
    float largest_scale = 0, largest_sigma_t = 0;
    for (const gpu::Particle& p : particles) {
        largest_scale = std::max(largest_scale, p.scale);
        largest_sigma_t = std::max(largest_sigma_t, p.sigma_t);
    }
    const float most = std::max(physics::supportRadius(largest_sigma_t, largest_scale * tick.falloff, tick.cut), 0.0f);
    for (const gpu::Particle& p : particles) {
        const glm::vec3 at = inLightSpace(tick, p.centre);
        if (glm::all(glm::greaterThan(at - most, bounds.lo)) && glm::all(glm::lessThan(at + most, bounds.hi))) continue;
        bounds.add(at, std::max(physics::supportRadius(p.sigma_t, p.scale * tick.falloff, tick.cut), 0.0f));
    }
    bounds.fallback();
    return bounds;
}

gpu::Phase phaseOf(const PhaseSettings& settings) {
    const PhaseLobes lobes = lobesOf(settings);
    return {float(lobes.part), float(lobes.asymmetry), float(lobes.draine), float(lobes.second)};
}

gpu::Fog fogOf(const Fog& fog) {
    constexpr float kNowhere = 1e30f;
    return {.centre = fog.centre,
            .radius = fog.radius > 0 ? fog.radius : kNowhere,
            .sigma_t = fog.extinction,
            .falloff = fog.falloff,
            .base = fog.height,
            .lo = double(fog.lo) > limits::kPlace.lo ? fog.lo : -kNowhere,
            .hi = double(fog.hi) < limits::kPlace.hi ? fog.hi : kNowhere,
            .albedo = fog.albedo,
            .emission = (1.0f - fog.albedo) * fog.emission,
            .phase = phaseOf(fog)};
}

void addFogs(gpu::Tick& tick, std::span<const Fog> fogs) {
    const Fog* first = nullptr;
    tick.fog_phases = 1;
    for (const Fog& fog : fogs) {
        if (!isThere(fog) || tick.fog_count == gpu::kMostFogs) continue;
        tick.fogs[tick.fog_count++] = fogOf(fog);
        if (!first) first = &fog;
        if (!(lobesOf(fog) == lobesOf(*first))) tick.fog_phases = 2;
    }
}

// Of the height map of meshes; without them it is one texel.
void addMeshes(gpu::Tick& tick, const Scene& scene) {
    LightBounds bounds;
    for (const Triangle& triangle : scene.triangles)
        for (const glm::vec3 corner : triangle.corners) bounds.add(inLightSpace(tick, corner), 0);
    bounds.fallback();
    tick.triangle_count = uint32_t(scene.triangles.size());
    tick.mesh_size = tick.triangle_count > 0 ? std::bit_floor(scene.render.opaque_shadow_size) : 1;
    const glm::vec2 margin = 1.0f / float(tick.mesh_size) * (glm::vec2(bounds.hi) - glm::vec2(bounds.lo));
    tick.mesh_lo = glm::vec2(bounds.lo) - margin;
    tick.mesh_hi = glm::vec2(bounds.hi) + margin;
}

} // namespace

void setSun(gpu::Tick& tick, glm::vec3 to_light) {
    tick.sun.to_light = to_light;
    const glm::vec3 helper = std::abs(to_light.y) < 0.9f ? glm::vec3(0, 1, 0) : glm::vec3(1, 0, 0);
    tick.map.x = glm::normalize(glm::cross(helper, to_light));
    tick.map.y = glm::cross(to_light, tick.map.x);
}

void ballsOf(std::span<const gpu::Particle> particles, std::span<const gpu::EllipsoidAxes> axes,
             std::vector<gpu::Particle>& out) {
    out.clear();
    if (axes.empty()) return;
    out.assign(particles.begin(), particles.end());
    for (size_t i = 0; i < out.size(); ++i) {
        const auto [a, b, c] = axes[i];
        const float bend = (1 / glm::dot(a, a) + 1 / glm::dot(b, b) + 1 / glm::dot(c, c)) / 3; // over the ball's
        const float part = 1 / std::sqrt(bend);
        out[i].scale *= part;
        out[i].sigma_t *= float(partOfBall(axes[i])) / (part * part * part);
    }
}

gpu::Tick makeTick(const Scene& scene, const SceneNow& now, std::span<const gpu::Particle> particles,
                   std::span<const gpu::Opaque> objects, std::span<const gpu::Particle> balls) {
    if (balls.empty()) balls = particles;
    gpu::Tick tick{};
    setSun(tick, now.light.to_light);
    tick.falloff = now.medium.falloff;
    tick.phase = phaseOf(now.medium);
    addFogs(tick, now.lists.fogs);
    tick.local_light_count = uint32_t(now.lists.lights.size());
    tick.sun.irradiance = now.light.irradiance;
    tick.opaque_count = uint32_t(objects.size());
    tick.plane_count = uint32_t(std::ranges::count(objects, gpu::kPlane, &gpu::Opaque::kind));
    if (tick.sun.to_light.y <= 0 && tick.plane_count > 0)
        tick.sun.irradiance = glm::vec3(0); // the light is below the ground
    tick.particle_count = uint32_t(particles.size());
    tick.cut = cutOf(balls, now.render.cutoff, tick.falloff);
    tick.ambient = scene.sky.ambient;
    const auto [emission, cold_albedo] = sootOf(now.medium);
    tick.emission = emission, tick.cold_albedo = cold_albedo;
    tick.sky_zenith = scene.sky.zenith;
    tick.sky_horizon = scene.sky.horizon;
    tick.haze = scene.sky.haze;
    tick.extinction = 1;
    tick.channels = gpu::kAllChannels;

    LightBounds medium = mediumBounds(particles, now.medium.model == kTetrahedraMedium, tick);
    if (now.render.shadow_extent > 0) {
        const glm::vec3 middle = inLightSpace(tick, scene.camera.target);
        medium.lo = middle - 0.5f * now.render.shadow_extent;
        medium.hi = middle + 0.5f * now.render.shadow_extent;
    }
    tick.map.lo = medium.lo;
    tick.map.hi = medium.hi;
    const glm::vec3 size = medium.hi - medium.lo;
    const glm::mat3 basis(tick.map.x, tick.map.y, tick.sun.to_light);
    setMultiple(tick, scene.sky, now, particles, objects);
    // No light: the smallest map.
    const bool dark = tick.sun.irradiance == glm::vec3(0) && tick.multiple.own == 0;
    const bool follow = now.render.shadow_size == 0 || now.render.shadow_slices == 0;
    const ShadowedMedium shadowed(follow && !dark ? balls : std::span<const gpu::Particle>(), tick.falloff, basis);
    const ShadowResolution resolution = dark ? ShadowResolution{} : shadowResolution(now.render, shadowed, size);
    tick.map.texels = resolution.texels;
    tick.map.slices = resolution.slices;
    tick.map.u = glm::vec4(tick.map.x, -medium.lo.x) / size.x;
    tick.map.v = glm::vec4(tick.map.y, -medium.lo.y) / size.y;
    tick.map.plane = glm::vec4(-tick.sun.to_light, medium.hi.z) * (float(tick.map.slices - 1) / size.z);

    if (needsBalls(now.medium, now.render)) setBalls(tick, now.medium, now.render, particles);
    addMeshes(tick, scene);
    LightBounds casters;
    for (const gpu::Opaque& o : objects) {
        if (o.kind == gpu::kSphere) casters.add(inLightSpace(tick, o.centre), o.half_size.x);
        if (o.kind != gpu::kBox) continue;
        for (int corner = 0; corner < 8; ++corner) {
            const glm::vec3 h = o.half_size * glm::vec3(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
            casters.add(inLightSpace(tick, o.centre + glm::vec3(o.yaw_cos * h.x + o.yaw_sin * h.z, h.y,
                                                                -o.yaw_sin * h.x + o.yaw_cos * h.z)),
                        0);
        }
    }
    tick.map.opaque_size = casters.lo.x <= casters.hi.x ? now.render.opaque_shadow_size : 1;
    casters.fallback();
    const glm::vec2 margin = 2.0f / float(tick.map.opaque_size) * (glm::vec2(casters.hi) - glm::vec2(casters.lo));
    tick.map.opaque_lo = glm::vec2(casters.lo) - margin; // a rim of empty texels, so that filtering meets no edge
    tick.map.opaque_hi = glm::vec2(casters.hi) + margin;
    return tick;
}

} // namespace brume
