#include "tests/gpu/closed_form.h"

#include <algorithm>
#include <cmath>

namespace brume::test {

namespace {

constexpr double kFar = 1e9;

struct Crossing {
    double closest; // m along the ray
    double line;    // optical depth of the whole line
    double peak;    // 1/m
};

Crossing cross(const reference::Blob& blob, const Ray& ray) {
    const glm::dvec3 centre = blob.centre - ray.eye;
    const double closest = glm::dot(centre, ray.w);
    const glm::dvec3 off = centre - closest * ray.w;
    const double across = std::exp(-blob.k * blob.k * glm::dot(off, off));
    return {closest, 2 * blob.half_line * across, blob.sigma_t * across};
}

} // namespace

const glm::vec3 kVertices[4] = {glm::vec3(1, 1, 1) / std::sqrt(3.0f), glm::vec3(1, -1, -1) / std::sqrt(3.0f),
                                glm::vec3(-1, 1, -1) / std::sqrt(3.0f), glm::vec3(-1, -1, 1) / std::sqrt(3.0f)};

int verticesBehind(const Point& p, const Pose& pose) {
    int behind = 0;
    for (const glm::vec3& vertex : kVertices) {
        const glm::vec3 view = glm::inverse(pose.orientation) * (p.centre + p.scale * vertex - pose.position);
        behind += -view.z < float(kNearDepth);
    }
    return behind;
}

Point thick(glm::vec3 centre, float scale, double depth, float falloff) {
    return {centre, scale, float(depth / (double(scale) * double(falloff) * std::sqrt(kPi / 50)))};
}

double allowed(double distance, double k, double depth) { return 3e-6 + 2e-7 * distance * k * depth; }

double subpixel(const gpu::Device& device) {
    return std::ldexp(1.0, -int(device.properties().limits.subPixelPrecisionBits));
}

std::vector<gpu::Particle> particlesOf(const Scene& scene) {
    const Simulation simulation(scene);
    std::vector<gpu::Particle> particles(simulation.liveCount());
    simulation.write(particles);
    return particles;
}

std::vector<reference::Blob> blobsOf(const Scene& scene) {
    return reference::blobsOf(particlesOf(scene), double(scene.medium.falloff));
}

Ray rayThrough(const Pose& pose, uint32_t width, uint32_t height, uint32_t x, uint32_t y) {
    const glm::dvec3 direction = pixelDirection(pose, width, height, x, y);
    return {pose.position, glm::normalize(direction), kNearDepth * glm::length(direction)};
}

Interval insideTetrahedron(const reference::Blob& blob, const Ray& ray) {
    Interval inside{ray.begin, kFar};
    for (const glm::dvec3& vertex :
         {glm::dvec3(1, 1, 1), glm::dvec3(1, -1, -1), glm::dvec3(-1, 1, -1), glm::dvec3(-1, -1, 1)}) {
        const glm::dvec3 outward = -vertex / std::sqrt(3.0); // of the face opposite to it, a third of the scale away
        const double away = glm::dot(outward, ray.w), room = blob.scale / 3 + glm::dot(outward, blob.centre - ray.eye);
        if (away > 0) inside.end = std::min(inside.end, room / away);
        if (away < 0) inside.begin = std::max(inside.begin, room / away);
        if (away == 0 && room < 0) inside.end = inside.begin;
    }
    return inside;
}

Interval insideTetrahedronDrawn(const reference::Blob& blob, const Pose& pose, uint32_t width, uint32_t height,
                                uint32_t x, uint32_t y, glm::dvec2 off) {
    const glm::dvec3 corner = pixelDirection(pose, width, height, 0, 0),
                     here = pixelDirection(pose, width, height, x, y);
    const glm::dvec3 there = here + off.x * (pixelDirection(pose, width, height, 1, 0) - corner) +
                             off.y * (pixelDirection(pose, width, height, 0, 1) - corner);
    const double scale = glm::length(here) / glm::length(there); // of distances, where view depths are the same
    const Interval inside =
        insideTetrahedron(blob, {glm::dvec3(pose.position), glm::normalize(there), kNearDepth * glm::length(there)});
    return {inside.begin * scale, inside.end * scale};
}

Interval wholeRay(const Ray& ray) { return {ray.begin, kFar}; }

double depthOn(const reference::Blob& blob, const Ray& ray, Interval interval) {
    if (!(interval.end > interval.begin)) return 0;
    const Crossing c = cross(blob, ray);
    const double near = blob.k * (interval.begin - c.closest), far = blob.k * (interval.end - c.closest);
    return 0.5 * c.line * (near > 0 ? std::erfc(near) - std::erfc(far) : std::erf(far) - std::erf(near));
}

double scatteredOn(const reference::Blob& blob, const Ray& ray, Interval interval,
                   const std::function<double(double)>& light_depth) {
    const Crossing c = cross(blob, ray);
    const Interval part{std::max(interval.begin, c.closest - reference::kReach / blob.k),
                        std::min(interval.end, c.closest + reference::kReach / blob.k)};
    constexpr int kSteps = 500; // at most 0.0184 standard lengths 1/k each
    double sum = 0;
    for (int i = 0; i <= kSteps && part.length() > 0; ++i) {
        const double t = part.begin + part.length() * i / kSteps, q = blob.k * (t - c.closest);
        const double rule = i == 0 || i == kSteps ? 1 : i % 2 == 1 ? 4 : 2;
        sum += rule * c.peak * std::exp(-q * q - depthOn(blob, ray, {interval.begin, t}) - light_depth(t));
    }
    return sum * part.length() / (3 * kSteps);
}

double simpson(const reference::Blob& blob, const Ray& ray, Interval interval, int steps,
               const std::function<double(double)>& light_depth) {
    const Crossing c = cross(blob, ray);
    double sum = 0;
    for (int i = 0; i <= 2 * steps; ++i) {
        const double t = interval.begin + interval.length() * i / (2 * steps), q = blob.k * (t - c.closest);
        const double rule = i == 0 || i == 2 * steps ? 1 : i % 2 == 1 ? 4 : 2;
        sum += rule * c.peak * std::exp(-q * q - depthOn(blob, ray, {interval.begin, t}) - light_depth(t));
    }
    return std::min(sum * interval.length() / (6 * steps), -std::expm1(-depthOn(blob, ray, interval)));
}

double transmittanceSpace(const reference::Blob& blob, const Ray& ray, Interval interval, int points,
                          const std::function<double(double)>& light_depth) {
    const std::vector<double> nodes[] = {
        {0}, {-std::sqrt(1.0 / 3), std::sqrt(1.0 / 3)}, {-std::sqrt(0.6), 0, std::sqrt(0.6)}};
    const std::vector<double> weights[] = {{1}, {0.5, 0.5}, {5.0 / 18, 4.0 / 9, 5.0 / 18}};
    const double whole = -std::expm1(-depthOn(blob, ray, interval));
    const Crossing c = cross(blob, ray);
    double sum = 0;
    for (int i = 0; i < points; ++i) {
        const double y = whole * 0.5 * (1 + nodes[points - 1][size_t(i)]); // the opacity reached at the node
        double lo = std::max(interval.begin, c.closest - 6 / blob.k),
               hi = std::min(interval.end, c.closest + 6 / blob.k);
        for (int halving = 0; halving < 60; ++halving) {
            const double middle = 0.5 * (lo + hi);
            (-std::expm1(-depthOn(blob, ray, {interval.begin, middle})) < y ? lo : hi) = middle;
        }
        sum += weights[points - 1][size_t(i)] * std::exp(-light_depth(lo));
    }
    return whole * sum;
}

double twoPoints(const reference::Blob& blob, const Ray& ray, Interval interval,
                 const std::function<double(double)>& light_depth) {
    const Crossing c = cross(blob, ray);
    const double a = std::max(blob.k * (interval.begin - c.closest), -7.0),
                 b = std::min(blob.k * (interval.end - c.closest), 7.0);
    constexpr int kSteps = 1000;
    double moments[3] = {}; // of e^(-q^2) on (a, b), by the midpoint rule
    for (int i = 0; i < kSteps; ++i) {
        const double q = a + (b - a) * (i + 0.5) / kSteps, weight = std::exp(-q * q);
        moments[0] += weight;
        moments[1] += weight * q;
        moments[2] += weight * q * q;
    }
    const double mean = moments[1] / moments[0], deviation = std::sqrt(moments[2] / moments[0] - mean * mean);
    const double depth = depthOn(blob, ray, interval);
    const double near = std::exp(-depth * 0.5 * std::erfc(std::sqrt(0.5))); // T_V at the nodes of a whole Gaussian
    const double far = std::exp(-depth * 0.5 * std::erfc(-std::sqrt(0.5)));
    const double sum = near * std::exp(-light_depth(c.closest + (mean - deviation) / blob.k)) +
                       far * std::exp(-light_depth(c.closest + (mean + deviation) / blob.k));
    return -std::expm1(-depth) * sum / (near + far);
}

} // namespace brume::test
