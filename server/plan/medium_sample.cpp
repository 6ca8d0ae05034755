#include "server/plan/medium_sample.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/plan/work.h"

namespace brume {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr size_t kMostEven = 80, kMostAround = 512, kMostNear = 24, kMostCandidates = 32768;

double square(double x) { return x * x; }

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
    const double weight = std::max(double(particles.size()) / double(std::max<size_t>(out.size(), 1)), 1.0);
    for (SampledParticle& p : out) p.weight = weight, p.widened = p.deviation * std::cbrt(weight);
    return out;
}

} // namespace

double depthBetween(const SampledParticle& p, glm::dvec3 from, glm::dvec3 direction, double length, bool own) {
    const glm::dvec3 to = p.centre - from;
    const double along = glm::dot(to, direction), apart = std::max(glm::dot(to, to) - along * along, 0.0);
    const double s = p.widened, peak = p.depth / p.deviation; // sqrt(2 pi) extinction
    const double g = apart < 40 * s * s ? std::exp(-0.5 * apart / (s * s)) : 0;
    if (g <= 0) return 0;
    const double scale = 1 / (std::numbers::sqrt2 * s);
    const double reached = 0.5 * (std::erf((length - along) * scale) + std::erf(along * scale));
    return (own ? 1 - 1 / p.weight : 1) * peak * s * g * reached;
}

MediumSample::TexelErrors::TexelErrors(const PlanScene& scene, std::span<const SampledParticle> all)
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

double MediumSample::TexelErrors::by(const SampledParticle& p, glm::dvec3 from, double count) const {
    const glm::dvec3 off = p.centre - from;
    const double s2 = square(p.widened), apart = square(glm::dot(off, x)) + square(glm::dot(off, y));
    if (apart > 40 * s2) return 0;
    const double before = 0.5 * std::erfc(-glm::dot(off, to_light) / std::sqrt(2 * s2));
    return count * kPi * square(p.depth / p.deviation) * before * std::exp(-0.5 * apart / s2) / (2 * kPi * s2);
}

MediumSample::MediumSample(const PlanScene& scene, std::span<const gpu::Particle> particles)
    : even_(chosen(scene, particles, kMostEven)), around_(chosen(scene, particles, kMostAround)),
      texels_(scene, around_) {
    for (SampledParticle& p : even_) lookAround(p);
    if (even_.empty() || even_.front().weight <= 1) return;
    candidates_ = chosen(scene, particles, kMostCandidates);
}

void MediumSample::lookAround(SampledParticle& at) const {
    at.extinction = at.depth / (std::sqrt(2 * kPi) * at.deviation);
    at.to_light = 0.5 * at.depth;
    double crowd = square(at.depth) / square(square(at.deviation)) / 4; // its own, on average
    for (const SampledParticle& p : around_) {
        const bool own = p.centre == at.centre;
        const glm::dvec3 off = p.centre - at.centre;
        const double s = p.widened, apart = glm::dot(off, off), others = own ? 1 - 1 / p.weight : 1;
        if (apart < 40 * s * s)
            at.extinction += others * p.depth / (std::sqrt(2 * kPi) * p.deviation) * std::exp(-0.5 * apart / (s * s));
        at.to_light += depthBetween(p, at.centre, texels_.to_light, 1e9, own);
        crowd += texels_.by(p, at.centre, others * p.weight);
    }
    at.crowding = texels_.uniform > 0 ? crowd / texels_.uniform : 1;
}

std::vector<SampledParticle> MediumSample::seenIn(const Pixels& pixels) const {
    if (candidates_.empty()) return even_;
    std::vector<std::pair<double, const SampledParticle*>> light; // pairs: added squared radiance, relative
    light.reserve(candidates_.size());
    for (const SampledParticle& p : candidates_) {
        const double seen = pixels(p.centre, p.deviation) * square(std::expm1(-p.depth));
        if (seen > 0) light.emplace_back(seen, &p);
    }
    if (light.empty()) return even_;
    std::vector<SampledParticle> out;
    if (2 * light.size() > candidates_.size()) {
        out = even_;
    } else { // Few of the medium's sample may be in the picture. Another one is of those that are, in their order.
        const size_t stride = (light.size() + kMostEven - 1) / kMostEven;
        for (size_t i = 0; i < light.size(); i += stride) out.push_back(*light[i].second);
        const double times = double(light.size()) / double(out.size());
        for (SampledParticle& p : out) {
            p.weight *= times, p.widened = p.deviation * std::cbrt(p.weight);
            lookAround(p);
        }
    }
    const size_t count = std::min(kMostNear, light.size());
    std::ranges::nth_element(light, light.begin() + ptrdiff_t(count - 1), std::greater<>());
    for (size_t i = 0; i < count; ++i) {
        SampledParticle near = *light[i].second;
        std::erase_if(out, [&](const SampledParticle& p) { return p.centre == near.centre; });
        lookAround(near);
        out.push_back(near);
    }
    return out;
}

} // namespace brume
