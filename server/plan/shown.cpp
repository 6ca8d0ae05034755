#include "server/plan/shown.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/inputs/eye_request.h"
#include "server/plan/work.h"

namespace brume {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr size_t kMost = 96, kMostAround = 512;
constexpr double kNear = double(kNearDepth);

double square(double x) { return x * x; }

// Deviation (m) of a particle in sums over the sample: that of what it stands for, with the same extinction.
double widened(const SampledParticle& p) { return p.deviation * std::cbrt(p.weight); }

// Optical depth of one particle between two points, `length` (m) apart along `direction` from `from`; without `own`
// part of what it stands for, itself.
double depthBetween(const SampledParticle& p, glm::dvec3 from, glm::dvec3 direction, double length, bool own) {
    const glm::dvec3 to = p.centre - from;
    const double along = glm::dot(to, direction), apart = std::max(glm::dot(to, to) - along * along, 0.0);
    const double s = widened(p), peak = p.depth / p.deviation; // sqrt(2 pi) extinction
    const double g = apart < 40 * s * s ? std::exp(-0.5 * apart / (s * s)) : 0;
    if (g <= 0) return 0;
    const double scale = 1 / (std::numbers::sqrt2 * s);
    const double reached = 0.5 * (std::erf((length - along) * scale) + std::erf(along * scale));
    return (own ? 1 - 1 / p.weight : 1) * peak * s * g * reached;
}

// At most so many particles, evenly chosen, each with the weight of those that it stands for.
std::vector<SampledParticle> chosen(const PlanScene& scene, std::span<const gpu::Particle> particles, size_t most) {
    std::vector<SampledParticle> out;
    const size_t stride = std::max<size_t>((particles.size() + most - 1) / most, 1);
    for (size_t i = 0; i < particles.size(); i += stride) {
        const gpu::Particle& p = particles[i];
        const double s = 0.1 * double(p.scale) * double(scene.tick.falloff);
        if (scene.support(p) <= 0) continue;
        out.push_back({.centre = p.centre, .deviation = s, .depth = std::sqrt(2 * kPi) * double(p.sigma_t) * s});
    }
    for (SampledParticle& p : out) p.weight = std::max(double(particles.size()) / double(out.size()), 1.0);
    return out;
}

// Errors of the volumetric shadow map's texels for a spacing of 1 m, squared: an interpolated Gaussian errs by a / s^2
// times the square of a spacing (a: optical depth, s: deviation). `uniform`: as if the medium filled a box.
struct TexelErrors {
    glm::dvec3 x, y, to_light;
    double uniform = 0;

    TexelErrors(const PlanScene& scene, std::span<const SampledParticle> all)
        : x(scene.tick.map.x), y(scene.tick.map.y), to_light(scene.tick.sun.to_light) {
        double mass = 0, squares = 0;
        glm::dvec2 first(0), second(0);
        for (const SampledParticle& p : all) {
            const double s2 = square(p.deviation), m = p.weight * 2 * kPi * p.depth * s2;
            const glm::dvec2 at(glm::dot(p.centre, x), glm::dot(p.centre, y));
            mass += m, first += m * at, second += m * (at * at + s2);
            squares += p.weight * kPi * square(p.depth) / s2;
        }
        if (!(mass > 0)) return;
        const glm::dvec2 mean = first / mass, size = glm::sqrt(12.0 * glm::max(second / mass - mean * mean, 1e-12));
        uniform = squares / (size.x * size.y) * std::min(1.0, size.x * size.y / mass);
    }

    // At `from`, by what `p` stands for.
    double by(const SampledParticle& p, glm::dvec3 from, double count) const {
        const glm::dvec3 off = p.centre - from;
        const double s2 = square(widened(p)), apart = square(glm::dot(off, x)) + square(glm::dot(off, y));
        if (apart > 40 * s2) return 0;
        const double before = 0.5 * std::erfc(-glm::dot(off, to_light) / std::sqrt(2 * s2));
        return count * kPi * square(p.depth / p.deviation) * before * std::exp(-0.5 * apart / s2) / (2 * kPi * s2);
    }
};

} // namespace

std::vector<SampledParticle> sampledParticles(const PlanScene& scene, std::span<const gpu::Particle> particles) {
    std::vector<SampledParticle> out = chosen(scene, particles, kMost);
    const std::vector<SampledParticle> all = chosen(scene, particles, kMostAround);
    const TexelErrors texels(scene, all);
    for (SampledParticle& at : out) {
        at.extinction = at.depth / (std::sqrt(2 * kPi) * at.deviation);
        at.to_light = 0.5 * at.depth;
        double crowd = square(at.depth) / square(square(at.deviation)) / 4; // its own, on average
        for (const SampledParticle& p : all) {
            const bool own = p.centre == at.centre;
            const glm::dvec3 off = p.centre - at.centre;
            const double s = widened(p), apart = glm::dot(off, off), others = own ? 1 - 1 / p.weight : 1;
            if (apart < 40 * s * s)
                at.extinction +=
                    others * p.depth / (std::sqrt(2 * kPi) * p.deviation) * std::exp(-0.5 * apart / (s * s));
            at.to_light += depthBetween(p, at.centre, texels.to_light, 1e9, own);
            crowd += texels.by(p, at.centre, others * p.weight);
        }
        at.crowding = texels.uniform > 0 ? crowd / texels.uniform : 1;
    }
    return out;
}

ShownMedium::ShownMedium(const PlanScene& scene, const PlanView& view) {
    struct Seen {
        glm::dvec2 at;    // pixels
        double projected; // pixels of a deviation
        double radiance;  // at its centre, relative
        double share;     // part of it that is in the picture
        bool cut;         // True: the near plane may cut it
        double oblique;   // squared distance from the view axis and deviation over depth
    };
    const std::span<const SampledParticle> all = scene.particles_of_sample;
    std::vector<Seen> seen(all.size(), Seen{});
    const Frustum frustum = frustumOf(view.pose, view.width, view.height);
    const double pixel = (double(frustum.up) + double(frustum.down)) / double(view.height);
    const glm::dmat3 axes(glm::mat3_cast(view.pose.orientation));
    const glm::dvec3 eye(view.pose.position);
    const auto part = [](double at, double reach, double least,
                         double most) { // part of at ± reach that is between them
        const double lo = std::max(at - reach, least), hi = std::min(at + reach, most);
        return std::clamp((hi - lo) / (2 * reach), 0.0, 1.0);
    };
    double light = 0, light_depth = 0, crowding = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        const SampledParticle& p = all[i];
        const glm::dvec3 to = p.centre - eye;
        const glm::dvec3 c(glm::dot(to, axes[0]), -glm::dot(to, axes[1]), -glm::dot(to, axes[2]));
        if (c.z + 2 * p.deviation <= kNear) continue;
        const double z = std::max({c.z, p.deviation, kNear}), distance = std::max(glm::length(to), kNear);
        Seen& s = seen[i];
        s.projected = p.deviation / (pixel * z);
        s.cut = c.z < 3.5 * p.deviation;
        s.at = glm::dvec2(c) / (pixel * z) + glm::dvec2(frustum.left, frustum.up) / pixel;
        s.share = part(s.at.x, 2 * s.projected, 0, view.width) * part(s.at.y, 2 * s.projected, 0, view.height);
        s.oblique = (c.x * c.x + c.y * c.y + p.deviation * p.deviation) / (z * z);
        if (s.share <= 0) continue;
        double before = 0;
        for (const SampledParticle& other : all)
            before += depthBetween(other, p.centre, -to / distance, distance, &other == &p);
        s.radiance = -std::expm1(-p.depth) * std::exp(-before - p.to_light);
        const double sent = p.weight * s.share * s.radiance * square(s.projected);
        light += sent, light_depth += sent * p.to_light, crowding += sent * p.crowding;
    }
    const bool inside = glm::all(glm::lessThanEqual(scene.extent.lo, view.pose.position)) &&
                        glm::all(glm::lessThanEqual(view.pose.position, scene.extent.hi));
    if (!(light > 0)) {
        // A few of many particles may be seen, and none of the sample: as a mean one, off the axis.
        if (all.empty() || all.front().weight <= 1) return;
        sizes_[count_++] = {.projected = projectedDeviation(scene.extent, view),
                            .deviation = double(scene.extent.deviation),
                            .part = 1,
                            .bend = 1,
                            .oblique = 0.1,
                            .cut = inside ? 1.0 : 0.0};
        return;
    }
    light_depth_ = light_depth / light;
    light_factor_ = std::max({std::sqrt(crowding / light), inside ? 0.8 * light_depth_ : 0, 1.0});
    double sum = 0; // squared radiance, summed over pixels
    for (size_t i = 0; i < all.size(); ++i) {
        const Seen& a = seen[i];
        if (!(a.radiance > 0)) continue;
        const double w = all[i].weight;
        sum += w * a.share * square(a.radiance) * kPi * square(a.projected);
        for (size_t j = 0; j < all.size(); ++j) {
            const Seen& b = seen[j];
            const double others = i == j ? w - 1 : w;
            if (!(b.radiance > 0) || others <= 0) continue;
            const double wide = square(a.projected) + square(b.projected) * std::pow(w, 2.0 / 3);
            const glm::dvec2 d = a.at - b.at;
            sum += w * others * a.share * a.radiance * b.radiance * 2 * kPi * square(a.projected * b.projected) / wide *
                   std::exp(-0.5 * glm::dot(d, d) / wide);
        }
    }
    for (size_t i = 0; i < all.size(); ++i) {
        const Seen& s = seen[i];
        if (!(s.radiance > 0)) continue;
        const double bin = 2 * std::log2(all[i].deviation / double(scene.extent.deviation)) + kSizes / 2.0;
        Size& size = sizes_[size_t(std::clamp(bin, 0.0, double(kSizes - 1)))];
        const double own = all[i].weight * s.share * square(s.radiance) * kPi * square(s.projected) / sum;
        const double outline = s.projected / std::sqrt(1 + 0.8 * std::log(std::max(all[i].to_light, 1.0)));
        size.projected += own * std::pow(outline, -6), size.deviation += own * std::pow(all[i].deviation, -6);
        size.part += own;
        size.bend += own * square(bendOf(std::sqrt(2 * kPi) * all[i].deviation * all[i].extinction));
        size.oblique += own * square(s.oblique);
        if (s.cut) size.cut += own;
        const double sent = all[i].weight * s.share * s.radiance * square(s.projected) / light;
        size.light += sent, size.extinction += sent * square(all[i].extinction);
    }
    for (const Size& size : sizes_) {
        if (!(size.part > 0)) continue;
        Size& mean = sizes_[count_++];
        mean = {.projected = std::pow(size.projected / size.part, -1.0 / 6),
                .deviation = std::pow(size.deviation / size.part, -1.0 / 6),
                .part = size.part,
                .bend = std::sqrt(size.bend / size.part),
                .oblique = std::sqrt(size.oblique / size.part),
                .cut = size.cut,
                .light = size.light,
                .extinction = std::sqrt(size.extinction / size.light)};
    }
}

double ShownMedium::bendOf(double depth) { return std::min(depth, 1.0) * std::pow(1 + depth / 12, 0.9); }

} // namespace brume
