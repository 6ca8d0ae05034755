#include "tools/reference/geometry.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "shaders/shared/ellipsoid.h"
#include "shaders/shared/glass.h"

namespace brume::reference {

namespace {

constexpr double kSkin = 1e-7; // m: so near its begin a ray hits no triangle, which may be where it comes from
constexpr Interval kNowhere{1, 0};
constexpr Interval kEverywhere{-kInfinity, kInfinity};

// What of the line has lo <= position + t * slope <= hi.
Interval between(double lo, double hi, double position, double slope) {
    if (slope == 0) return position >= lo && position <= hi ? kEverywhere : kNowhere;
    const double a = (lo - position) / slope, b = (hi - position) / slope;
    return {std::min(a, b), std::max(a, b)};
}

// Real roots of a t^2 + 2 b t + c, without cancellation.
void roots(double a, double b, double c, std::vector<double>& t) {
    const double discriminant = b * b - a * c;
    if (discriminant < 0) return;
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    if (a != 0) t.push_back(q / a);
    if (q != 0) t.push_back(c / q);
}

// A box's own axes in the world: yaw about +Y.
std::array<glm::dvec3, 3> axesOf(const Obstacle& box) {
    const double c = std::cos(box.yaw), s = std::sin(box.yaw);
    return {glm::dvec3(c, 0, -s), glm::dvec3(0, 1, 0), glm::dvec3(s, 0, c)};
}

struct BoxCrossing {
    Interval inside;
    glm::dvec3 normal; // where it is entered
};
BoxCrossing crossBox(const Obstacle& box, const Ray& ray) {
    BoxCrossing crossing{kEverywhere, glm::dvec3(0)};
    const auto axes = axesOf(box);
    for (int i = 0; i < 3; ++i) {
        const double slope = glm::dot(axes[i], ray.direction), half = box.half_size[i];
        const Interval part = between(-half, half, glm::dot(axes[i], ray.origin - box.centre), slope);
        if (part.begin > crossing.inside.begin) crossing.normal = slope > 0 ? -axes[i] : axes[i];
        crossing.inside = common(crossing.inside, part);
    }
    return crossing;
}

glm::dvec3 normalOf(const Obstacle& triangle) {
    return glm::cross(triangle.corners[1] - triangle.corners[0], triangle.corners[2] - triangle.corners[0]);
}

// Where the ray goes through the triangle: an interval without length but for its last bit.
Interval crossTriangle(const Obstacle& triangle, const Ray& ray) {
    double sides[3], along[3], sum = 0, t = 0; // sides: volumes of the ray's direction with each edge
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 a = triangle.corners[(i + 1) % 3] - ray.origin, b = triangle.corners[(i + 2) % 3] - ray.origin;
        sides[i] = glm::dot(ray.direction, glm::cross(a, b - a));
        along[i] = glm::dot(ray.direction, triangle.corners[i] - ray.origin);
        sum += sides[i];
    }
    const bool inside =
        (sides[0] >= 0 && sides[1] >= 0 && sides[2] >= 0) || (sides[0] <= 0 && sides[1] <= 0 && sides[2] <= 0);
    if (!inside || sum == 0) return kNowhere;
    for (int i = 0; i < 3; ++i) t += sides[i] / sum * along[i];
    return t > ray.begin + kSkin ? Interval{t, std::nextafter(t, kInfinity)} : kNowhere;
}

Interval insideObstacle(const Obstacle& o, const Ray& ray) {
    if (o.kind == Obstacle::Kind::sphere) return insideSphere(o.centre, o.half_size.x, ray);
    if (o.kind == Obstacle::Kind::box) return crossBox(o, ray).inside;
    if (o.kind == Obstacle::Kind::triangle) return crossTriangle(o, ray);
    const double t = (o.centre.y - ray.origin.y) / ray.direction.y; // met from above only
    return ray.direction.y < 0 && t > ray.begin ? Interval{t, kInfinity} : kNowhere;
}

// Normal of the plane that holds an edge and the light.
glm::dvec3 edgeNormal(glm::dvec3 vertex, glm::dvec3 along, const LightSource& light) {
    return glm::cross(along, light.kind == LightSource::Kind::directional ? light.to_light : light.position - vertex);
}

// Where the ray's line crosses that plane.
void edgeCrossing(glm::dvec3 vertex, glm::dvec3 along, const LightSource& light, const Ray& ray,
                  std::vector<double>& t) {
    const glm::dvec3 normal = edgeNormal(vertex, along, light);
    const double slope = glm::dot(normal, ray.direction);
    if (slope != 0) t.push_back(glm::dot(normal, vertex - ray.origin) / slope);
}

// kTetrahedron * scale / sqrt 3 are the vertices about the centre; the face opposite to each is at scale / 3.
constexpr std::array<glm::dvec3, 4> kTetrahedron = {glm::dvec3(1, 1, 1), glm::dvec3(1, -1, -1), glm::dvec3(-1, 1, -1),
                                                    glm::dvec3(-1, -1, 1)};

} // namespace

Interval common(Interval a, Interval b) { return {std::max(a.begin, b.begin), std::min(a.end, b.end)}; }

Interval insideSphere(glm::dvec3 centre, double radius, const Ray& ray) {
    const double closest = glm::dot(centre - ray.origin, ray.direction);
    const glm::dvec3 off = centre - ray.at(closest);
    const double half_squared = radius * radius - glm::dot(off, off);
    if (half_squared <= 0) return kNowhere;
    return {closest - std::sqrt(half_squared), closest + std::sqrt(half_squared)};
}

Interval insideFog(const Fog& fog, const Ray& ray) {
    const Interval slab = between(fog.lo, fog.hi, ray.origin.y, ray.direction.y);
    return std::isinf(fog.radius) ? slab : common(slab, insideSphere(fog.centre, fog.radius, ray));
}

Interval insideTetrahedron(const Blob& blob, const SemiAxes* axes, const Ray& ray) {
    const auto inAxes = [&](glm::dvec3 x) { return axes ? physics::inSemiAxes(x, axes->a, axes->b, axes->c) : x; };
    const glm::dvec3 origin = inAxes(ray.origin - blob.centre), direction = inAxes(ray.direction);
    Interval inside = kEverywhere;
    for (const glm::dvec3& vertex : kTetrahedron) {
        const glm::dvec3 outward = -vertex / std::sqrt(3.0);
        inside = common(inside,
                        between(-kInfinity, blob.scale / 3, glm::dot(outward, origin), glm::dot(outward, direction)));
    }
    return inside;
}

double depthOn(const Fog& fog, const Ray& ray) {
    const Interval part = common(insideFog(fog, ray), {ray.begin, ray.end});
    if (part.empty() || fog.sigma_t == 0) return 0;
    const double length = part.end - part.begin, slope = fog.falloff * ray.direction.y;
    if (slope == 0) return fog.sigma_t * std::exp(-fog.falloff * (ray.origin.y - fog.base)) * length;
    // From the denser end, so that the exponent is never positive.
    const double densest = slope > 0 ? part.begin : part.end;
    if (std::isinf(densest)) return kInfinity;
    const double density = fog.sigma_t * std::exp(-fog.falloff * (ray.at(densest).y - fog.base));
    return density * -std::expm1(-std::abs(slope) * length) / std::abs(slope);
}

double distanceOfDepth(const Fog& fog, const Ray& ray, double depth) {
    const Interval part = common(insideFog(fog, ray), {ray.begin, ray.end});
    if (part.empty() || fog.sigma_t == 0) return kInfinity;
    const double slope = fog.falloff * ray.direction.y;
    const double density = fog.sigma_t * std::exp(-fog.falloff * (ray.at(part.begin).y - fog.base));
    const double x = depth * slope / density;
    if (x >= 1) return kInfinity;
    const double t = part.begin + (slope == 0 ? depth / density : -std::log1p(-x) / slope);
    return t < part.end ? t - ray.begin : kInfinity;
}

void insideUnion(const UnionMedium& medium, const Ray& ray, std::vector<Interval>& parts) {
    parts.clear();
    for (const UnionMedium::Ball& ball : medium.balls) {
        const Interval part = common(insideSphere(ball.centre, ball.radius, ray), {ray.begin, ray.end});
        if (!part.empty()) parts.push_back(part);
    }
    std::sort(parts.begin(), parts.end(), [](Interval a, Interval b) { return a.begin < b.begin; });
    size_t count = 0;
    for (const Interval part : parts) {
        if (count > 0 && part.begin <= parts[count - 1].end)
            parts[count - 1].end = std::max(parts[count - 1].end, part.end);
        else
            parts[count++] = part;
    }
    parts.resize(count);
}

Hit nearest(std::span<const Obstacle> obstacles, const Ray& ray) {
    Hit hit;
    for (int i = 0; i < static_cast<int>(obstacles.size()); ++i) {
        const Obstacle& o = obstacles[i];
        const Interval inside = insideObstacle(o, ray);
        if (inside.empty() || inside.begin < ray.begin || inside.begin > ray.end || inside.begin >= hit.t) continue;
        hit = {inside.begin, i, {0, 1, 0}};
        if (o.kind == Obstacle::Kind::sphere) hit.normal = glm::normalize(ray.at(hit.t) - o.centre);
        if (o.kind == Obstacle::Kind::box) hit.normal = crossBox(o, ray).normal;
        if (o.kind == Obstacle::Kind::triangle) {
            const glm::dvec3 normal = glm::normalize(normalOf(o));
            hit.normal = glm::dot(normal, ray.direction) < 0 ? normal : -normal;
        }
    }
    return hit;
}

void sheetsOn(const World& world, const Ray& ray, std::vector<SheetHit>& hits) {
    hits.clear();
    for (const Sheet& sheet : world.sheets) {
        const double t =
            physics::glassAt(sheet.centre - ray.origin, sheet.across, sheet.along, sheet.normal, ray.direction);
        if (!(t >= std::max(ray.begin, 0.0) && t < ray.end)) continue;
        const double mirrors = physics::glassMirrors(sheet.reflectance, glm::dot(sheet.normal, ray.direction));
        hits.push_back({t, (1 - mirrors) * sheet.transmittance,
                        mirrors * skyRadiance(world, glm::reflect(ray.direction, sheet.normal))});
    }
    std::ranges::stable_sort(hits, {}, &SheetHit::t);
}

bool occluded(std::span<const Obstacle> obstacles, const Ray& ray, int skip) {
    for (int i = 0; i < static_cast<int>(obstacles.size()); ++i)
        if (i != skip && !common(insideObstacle(obstacles[i], ray), {ray.begin, ray.end}).empty()) return true;
    return false;
}

void coneCrossings(glm::dvec3 apex, glm::dvec3 axis, double cosine_squared, const Ray& ray, std::vector<double>& t) {
    const glm::dvec3 from = ray.origin - apex;
    const double along = glm::dot(axis, ray.direction), start = glm::dot(axis, from);
    roots(along * along - cosine_squared, along * start - cosine_squared * glm::dot(from, ray.direction),
          start * start - cosine_squared * glm::dot(from, from), t);
}

void shadowEdges(const Obstacle& object, const LightSource& light, const Ray& ray, std::vector<double>& t) {
    if (object.kind == Obstacle::Kind::plane) {
        if (ray.direction.y != 0) t.push_back((object.centre.y - ray.origin.y) / ray.direction.y);
    } else if (object.kind == Obstacle::Kind::box) {
        const auto axes = axesOf(object);
        for (int i = 0; i < 3; ++i)
            for (const double a : {-1, 1})
                for (const double b : {-1, 1}) {
                    const int j = (i + 1) % 3, m = (i + 2) % 3;
                    edgeCrossing(object.centre + a * object.half_size[j] * axes[j] + b * object.half_size[m] * axes[m],
                                 axes[i], light, ray, t);
                }
    } else if (object.kind == Obstacle::Kind::triangle) {
        for (int i = 0; i < 3; ++i) {
            const glm::dvec3 vertex = object.corners[i], along = object.corners[(i + 1) % 3] - vertex;
            const glm::dvec3 normal = edgeNormal(vertex, along, light);
            const double here = glm::dot(normal, object.corners[(i + 2) % 3] - vertex);
            // The shadow of the triangle beyond the edge goes on where this one's ends.
            if (object.beyond[i] && here * glm::dot(normal, *object.beyond[i] - vertex) < 0) continue;
            edgeCrossing(vertex, along, light, ray, t);
        }
    } else if (light.kind == LightSource::Kind::directional) { // the sphere's shadow is a cylinder
        const glm::dvec3 w = ray.direction - glm::dot(ray.direction, light.to_light) * light.to_light;
        glm::dvec3 from = ray.origin - object.centre;
        from -= glm::dot(from, light.to_light) * light.to_light;
        roots(glm::dot(w, w), glm::dot(w, from), glm::dot(from, from) - object.half_size.x * object.half_size.x, t);
    } else {
        const glm::dvec3 toward = object.centre - light.position;
        const double squared = glm::dot(toward, toward), radius = object.half_size.x;
        if (squared > radius * radius)
            coneCrossings(light.position, glm::normalize(toward), 1 - radius * radius / squared, ray, t);
    }
}

void shadowEdges(const Blob& tetrahedron, const LightSource& light, const Ray& ray, std::vector<double>& t) {
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < i; ++j)
            edgeCrossing(tetrahedron.centre + tetrahedron.scale / std::sqrt(3.0) * kTetrahedron[i],
                         kTetrahedron[i] - kTetrahedron[j], light, ray, t);
    const Interval faces = insideTetrahedron(tetrahedron, nullptr, ray); // where the point itself goes in and out
    if (!faces.empty()) t.insert(t.end(), {faces.begin, faces.end});
}

} // namespace brume::reference
