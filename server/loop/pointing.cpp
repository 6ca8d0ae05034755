#include "server/loop/pointing.h"

#include <algorithm>
#include <cmath>

#include "server/sim/obstacles.h"
#include "shaders/shared/transmittance.h"

namespace brume {
namespace {

constexpr size_t kMostRays = 8;            // of one look
constexpr uint32_t kMostParticles = 65536; // of a medium with more, every so many are looked at
constexpr double kFar = 1e5;               // m
constexpr double kLeastHidden = 0.02;      // a part of the ray
constexpr double kBeside = 4;              // 1/k: a Gaussian farther from the ray than this is not on it
constexpr double kFine = 0.01;             // m

} // namespace

Pointing::Pointing() = default;
Pointing::~Pointing() = default;
void Pointing::forget() { solids_.reset(); }

double Pointing::depthUpTo(double metres) const {
    double depth = 0;
    for (const OnRay& one : on_ray_) {
        const double from = -one.centre * one.k, to = (metres - one.centre) * one.k;
        depth += 0.5 * one.line * (std::erf(to) - std::erf(from));
    }
    return depth;
}

std::optional<float> Pointing::depthOf(const PointingRay& ray, const Obstacles& solids,
                                       std::span<const gpu::Particle> particles, float falloff) {
    const glm::dvec3 origin(ray.origin), direction(ray.direction);
    const std::optional<double> part = solids.firstMet(origin, kFar * direction);
    const double surface = part ? *part * kFar : kFar;
    on_ray_.clear();
    double end = 0;
    for (const gpu::Particle& particle : particles) {
        const glm::dvec3 off = glm::dvec3(particle.centre) - origin;
        const double along = glm::dot(off, direction), k = double(physics::gaussianK(particle.scale, falloff));
        const double across = std::max(glm::dot(off, off) - along * along, 0.0);
        if (across * k * k > kBeside * kBeside || along < -kBeside / k) continue;
        on_ray_.push_back(
            {along, k, physics::lineDepth(double(particle.sigma_t), k, physics::gaussianAcross(k, across))});
        end = std::max(end, along + kBeside / k);
    }
    end = std::min(end, surface);
    const double hidden = -std::expm1(-depthUpTo(end));
    if (part && hidden < 0.5) return float(surface);
    if (hidden < kLeastHidden) return {};
    double near = 0, far = end;
    while (far - near > kFine) {
        const double middle = 0.5 * (near + far);
        (-std::expm1(-depthUpTo(middle)) < 0.5 * hidden ? near : far) = middle;
    }
    return float(0.5 * (near + far));
}

void Pointing::follow(const Scene& scene, const Simulation& simulation, People& people) {
    const std::vector<People::Moved> moved = people.takeMoved(kMostRays);
    if (moved.empty()) return;
    if (!solids_) solids_ = std::make_unique<Obstacles>(scene);
    solids_->follow(simulation.now().lists, simulation.listsHash());
    const uint32_t every = (simulation.liveCount() + kMostParticles - 1) / kMostParticles;
    particles_.resize(every == 0 ? 0 : (simulation.liveCount() + every - 1) / every);
    if (every > 0) simulation.write(particles_, every);
    for (gpu::Particle& particle : particles_) particle.sigma_t *= float(every);
    for (const People::Moved& one : moved) {
        const auto metres = depthOf(one.ray, *solids_, particles_, simulation.now().medium.falloff);
        people.meets(one, metres ? std::optional(one.ray.origin + *metres * one.ray.direction) : std::nullopt);
    }
}

} // namespace brume
