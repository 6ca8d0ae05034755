#include "tools/reference/lighting.h"

#include <algorithm>
#include <cmath>

#include "shaders/shared/sky.h"
#include "tools/reference/geometry.h"

namespace brume::reference {

using Kind = LightSource::Kind;

Arrival arrivalAt(const LightSource& light, glm::dvec3 x) {
    if (light.kind == Kind::directional) return {light.colour, light.to_light, kInfinity};
    const glm::dvec3 toward = light.position - x;
    const double distance = glm::length(toward);
    const glm::dvec3 to_light = toward / distance;
    const double squares = distance * distance / (light.range * light.range); // 0 without a range
    const double window = std::max(1 - squares * squares, 0.0);
    double part = window * window / (distance * distance + light.radius * light.radius);
    if (light.kind == Kind::spot) {
        const double u = (-glm::dot(to_light, light.axis) - light.cos_outer) / (light.cos_inner - light.cos_outer);
        const double v = std::clamp(u, 0.0, 1.0);
        part *= v * v * (3 - 2 * v);
    }
    return {light.colour * part, to_light, distance};
}

Lighting::Lighting(const World& world, double reach, bool shadows, double cells)
    : world_(world), obstacles_(world.obstacles), tetrahedra_(world.tetrahedra), voxels_(world.voxels),
      shadows_(shadows) {
    for (const LightSource& light : world.lights) {
        Fields& fields = fields_.emplace_back();
        if (!shadows || world.cut_light) continue;
        if (light.kind == Kind::directional)
            fields.distant.emplace(world.blobs, light.to_light, reach, cells, world.axes);
        else
            fields.near.emplace(world.blobs, light.position, reach, world.axes);
    }
}

double Lighting::cutDepth(const Ray& toward) const {
    double sum = 0;
    for (size_t i = 0; i < world_.blobs.size(); ++i) {
        const Blob& b = world_.blobs[i];
        const BlobOnLine on = onLine(b, axesOf(world_, i), toward.origin, toward.direction);
        if (on.b2 * on.k * on.k >= b.scale * b.scale * b.k * b.k) continue;
        const Interval part = common(insideTetrahedron(b, axesOf(world_, i), toward), {toward.begin, toward.end});
        if (part.empty()) continue;
        sum += on.half_line * std::exp(-on.k * on.k * on.b2) *
               (table_.erf(on.k * (part.end - on.closest)) - table_.erf(on.k * (part.begin - on.closest)));
    }
    return sum;
}

double Lighting::depth(size_t i, glm::dvec3 x, const Arrival& arrival, int skip) const {
    if (!shadows_) return 0;
    const Ray toward{x, arrival.to_light, 0, arrival.distance};
    double sum = 0;
    for (const Fog& fog : world_.fogs) sum += depthOn(fog, toward);
    if (!world_.lights[i].shadows) return sum;
    if (obstacles_.occluded(toward, skip)) return kInfinity;
    sum += world_.cut_light     ? cutDepth(toward)
           : fields_[i].distant ? fields_[i].distant->depth(x)
                                : fields_[i].near->depth(x);
    if (!world_.balls.balls.empty()) {
        std::vector<Interval> parts;
        insideUnion(world_.balls, toward, parts);
        for (const Interval part : parts) sum += world_.balls.sigma_t * (part.end - part.begin);
    }
    return sum + tetrahedra_.depth(toward) + voxels_.depth(toward);
}

void Lighting::scattered(glm::dvec3 x, glm::dvec3 w, std::span<const PhaseLobes> phases,
                         std::span<glm::dvec3> sums) const {
    std::fill(sums.begin(), sums.end(), glm::dvec3(0));
    for (size_t i = 0; i < world_.lights.size(); ++i) {
        const Arrival arrival = arrivalAt(world_.lights[i], x);
        if (arrival.irradiance == glm::dvec3(0)) continue;
        const glm::dvec3 light = arrival.irradiance * std::exp(-depth(i, x, arrival));
        for (size_t p = 0; p < phases.size(); ++p) sums[p] += light * phase(phases[p], -arrival.to_light, -w);
    }
}

glm::dvec3 Lighting::surface(const Hit& hit, const Ray& ray) const {
    const glm::dvec3 x = ray.at(hit.t), normal = hit.normal;
    glm::dvec3 light = world_.sky_horizon * physics::skySeen(normal.y) +
                       (world_.sky_zenith - world_.sky_horizon) * physics::skyZenithSeen(normal.y);
    for (size_t i = 0; i < world_.lights.size(); ++i) {
        const Arrival arrival = arrivalAt(world_.lights[i], x);
        const double cosine = glm::dot(normal, arrival.to_light);
        if (cosine > 0) light += arrival.irradiance * (cosine / kPi * std::exp(-depth(i, x, arrival, hit.object)));
    }
    return albedoAt(world_.obstacles[hit.object], ray, hit.t) * light;
}

void Lighting::edges(const Ray& ray, std::vector<double>& t) const {
    for (const LightSource& light : world_.lights) {
        if (light.kind != Kind::directional) t.push_back(glm::dot(light.position - ray.origin, ray.direction));
        if (light.kind == Kind::spot) {
            coneCrossings(light.position, light.axis, light.cos_outer * light.cos_outer, ray, t);
            coneCrossings(light.position, light.axis, light.cos_inner * light.cos_inner, ray, t);
        }
        if (!std::isinf(light.range)) {
            const Interval lit = insideSphere(light.position, light.range, ray);
            if (!lit.empty()) t.push_back(lit.begin), t.push_back(lit.end);
        }
        if (!shadows_) continue;
        if (light.shadows) {
            obstacles_.shadowEdges(light, ray, t);
            tetrahedra_.shadowEdges(light, ray, t);
            for (const UnionMedium::Ball& ball : world_.balls.balls)
                shadowEdges({Obstacle::Kind::sphere, ball.centre, glm::dvec3(ball.radius), 0, {}}, light, ray, t);
            if (world_.cut_light)
                for (const Blob& blob : world_.blobs) shadowEdges(blob, light, ray, t);
        }
        for (const Fog& fog : world_.fogs) // where the light leaves through its ends
            if (!std::isinf(fog.radius))
                shadowEdges({Obstacle::Kind::sphere, fog.centre, glm::dvec3(fog.radius), 0, {}}, light, ray, t);
    }
}

} // namespace brume::reference
