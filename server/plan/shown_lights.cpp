#include "server/plan/shown_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/inputs/eye_request.h"
#include "server/inputs/local_light_block.h"
#include "server/plan/work.h"

namespace brume {
namespace {

constexpr double kPi = std::numbers::pi, kRootOfTwoPi = 2.5066282746310002;
constexpr double kNear = double(kNearDepth);
constexpr size_t kMostLights = 6;          // that stand for all
constexpr double kReachBeyond = 20;        // pixels beyond the picture from which a light's glow still counts
constexpr double kSide = 3;                // deviations from a particle's centre that its near side is at
constexpr double kBright = 1.5;            // and its brighter half
constexpr double kDirection = 0.0563;      // rad between neighbouring directions of a volume, on average
constexpr double kInterpolated = 1.0 / 12; // what linear interpolation leaves, of a squared spacing in deviations

double square(double x) { return x * x; }
// What linear interpolation leaves of a Gaussian, `spacing` in its deviations: at most all of it.
double interpolated(double spacing) { return std::min(kInterpolated * square(spacing), 1.0); }

double brightness(glm::vec3 colour) { return double(colour.r) + double(colour.g) + double(colour.b); }

// The picture's places.
class Picture {
public:
    explicit Picture(const PlanView& view)
        : frustum_(frustumOf(view.pose, view.width, view.height)),
          pixel_((double(frustum_.up) + double(frustum_.down)) / double(view.height)),
          axes_(glm::mat3_cast(view.pose.orientation)), eye_(view.pose.position), size_(view.width, view.height) {}

    double pixel() const { return pixel_; } // m per m of view depth
    glm::dvec3 eye() const { return eye_; }
    double depth(glm::dvec3 at) const { return -glm::dot(at - eye_, axes_[2]); } // m
    // Of the middle of something of this length.
    glm::dvec2 pixelOf(glm::dvec3 at, double length) const {
        const double z = std::max({depth(at), length, kNear});
        return glm::dvec2(glm::dot(at - eye_, axes_[0]), -glm::dot(at - eye_, axes_[1])) / (pixel_ * z) +
               glm::dvec2(frustum_.left, frustum_.up) / pixel_;
    }
    double projected(glm::dvec3 at, double length) const {
        return length / (pixel_ * std::max({depth(at), length, kNear}));
    }
    // Part of a particle that is in the picture.
    double share(glm::dvec3 at, double deviation) const {
        if (depth(at) + 2 * deviation <= kNear) return 0;
        const double reach = 2 * projected(at, deviation);
        const glm::dvec2 middle = pixelOf(at, deviation);
        const glm::dvec2 inside = glm::min(middle + reach, size_) - glm::max(middle - reach, glm::dvec2(0));
        const glm::dvec2 part = glm::clamp(inside / (2 * reach), 0.0, 1.0);
        return part.x * part.y;
    }
    bool holds(glm::dvec3 at) const {
        const glm::dvec2 middle = pixelOf(at, 0);
        return depth(at) > kNear && glm::all(glm::greaterThan(middle, glm::dvec2(-kReachBeyond))) &&
               glm::all(glm::lessThan(middle, size_ + kReachBeyond));
    }

private:
    Frustum frustum_;
    double pixel_;
    glm::dmat3 axes_;
    glm::dvec3 eye_;
    glm::dvec2 size_;
};

// The part of its intensity that a light sends to a particle: by its range, which may end in the particle's near side,
// and 0 where its cone leaves it out.
double sentTo(const gpu::LocalLight& light, glm::dvec3 away, double deviation) {
    const double distance = std::max(glm::length(away), 1e-6);
    if (light.cos_outer > -1) {
        const double angle = std::acos(std::clamp(glm::dot(away / distance, glm::dvec3(light.axis)), -1.0, 1.0));
        if (angle > std::acos(double(light.cos_outer)) + 2 * deviation / distance) return 0;
    }
    const double nearest = std::max(distance - kSide * deviation, 0.0);
    return square(std::max(1 - std::pow(nearest / double(light.range), 4), 0.0));
}

// What a light sends to a particle, past nothing.
double arriving(const gpu::LocalLight& light, const SampledParticle& p) {
    const glm::dvec3 away = p.centre - glm::dvec3(light.position);
    return brightness(light.intensity) * sentTo(light, away, p.deviation) /
           (glm::dot(away, away) + square(p.deviation) + square(double(light.radius)));
}

// The brightest lights, with the intensity of the others added to theirs.
std::vector<gpu::LocalLight> brightest(const PlanScene& scene, std::span<const SampledParticle> particles) {
    std::vector<std::pair<double, const gpu::LocalLight*>> all;
    double sum = 0, kept = 0;
    for (const gpu::LocalLight& light : scene.local_lights) {
        double most = 0;
        for (const SampledParticle& p : particles) most = std::max(most, arriving(light, p));
        if (most > 0) all.emplace_back(most, &light), sum += most;
    }
    const size_t count = std::min(kMostLights, all.size());
    std::ranges::partial_sort(all, all.begin() + ptrdiff_t(count), std::greater<>());
    std::vector<gpu::LocalLight> out;
    for (size_t i = 0; i < count; ++i) out.push_back(*all[i].second), kept += all[i].first;
    for (gpu::LocalLight& light : out) {
        light.intensity *= float(sum / kept);
        setVolume(light, scene.extent, 0);
        if (light.shadows == 0) light.volume = gpu::kNoVolume;
    }
    return out;
}

// Optical depth between a light and a particle's centre, and what the light's volume errs there.
struct Dimming {
    double depth = 0, directions = 0, shells = 0;
};
Dimming dimming(const gpu::LocalLight& light, const SampledParticle& at, std::span<const SampledParticle> all) {
    if (light.volume == gpu::kNoVolume) return {};
    const glm::dvec3 from(light.position), to = at.centre - from;
    const double distance = std::max(glm::length(to), 1e-6);
    Dimming out;
    double squares = 0;
    for (const SampledParticle& p : all) {
        const double depth = depthBetween(p, at.centre, -to / distance, distance, &p == &at);
        const double apart = kDirection * glm::length(p.centre - from) / p.deviation;
        out.depth += depth, squares += square(depth * interpolated(apart)) / p.weight;
    }
    out.depth += at.depth * std::min(0.5, 0.4 * distance / at.deviation); // its own
    out.directions = std::sqrt(squares);
    out.shells = at.extinction * at.deviation * interpolated(double(light.volume_step) / at.deviation);
    return out;
}

// The medium at a place: extinction, and the length in which it changes by itself.
struct Local {
    double extinction = 0, length = 0;
};
Local mediumAt(glm::dvec3 place, std::span<const SampledParticle> particles) {
    Local out;
    double slope = 0;
    for (const SampledParticle& p : particles) {
        const double x = glm::distance(place, p.centre) / (p.deviation * std::cbrt(p.weight));
        const double e = p.depth / (kRootOfTwoPi * p.deviation) * std::exp(-0.5 * x * x);
        out.extinction += e, slope += e * std::sqrt(x * x + 0.25) / p.deviation;
    }
    out.length = slope > 0 ? out.extinction / slope : 0;
    return out;
}

size_t binOf(double value, size_t bins) {
    return size_t(std::clamp(2 * std::log2(std::max(value, 1e-30)) + double(bins) / 2, 0.0, double(bins - 1)));
}

// Leaves out empty bins. The others' value becomes the mean.
template <class Bin, size_t count>
size_t packed(std::array<Bin, count>& bins, double Bin::*value, double total) {
    size_t filled = 0;
    for (Bin bin : bins) {
        if (!(bin.part > 0)) continue;
        bin.*value /= bin.part, bin.part /= total;
        bins[filled++] = bin;
    }
    return filled;
}

} // namespace

ShownLights::ShownLights(const PlanScene& scene, const PlanView& view) {
    const std::vector<gpu::LocalLight> lights = brightest(scene, scene.medium_sample.even());
    if (lights.empty()) return;
    const Picture picture(view);
    const std::vector<SampledParticle> all = scene.medium_sample.seenIn([&](glm::dvec3 centre, double deviation) {
        return picture.share(centre, deviation) * square(picture.projected(centre, deviation));
    });
    const double sun = brightness(scene.tick.sun.irradiance), unit = double(scene.extent.deviation);
    double total = 0, directions = 0, shells = 0; // squared radiance, summed over pixels
    for (const SampledParticle& p : all) {
        const double share = picture.share(p.centre, p.deviation), wide = picture.projected(p.centre, p.deviation);
        if (share <= 0) continue;
        const glm::dvec3 to = p.centre - picture.eye();
        const double distance = std::max(glm::length(to), kNear);
        double before = 0;
        for (const SampledParticle& other : all)
            before += depthBetween(other, p.centre, -to / distance, distance, &other == &p);
        const double seen = -std::expm1(-p.depth) * std::exp(-before), pixels = p.weight * share * square(wide);
        std::array<double, kMostLights> sent{};
        std::array<Dimming, kMostLights> dimmed;
        double local = 0;
        for (size_t l = 0; l < lights.size(); ++l) {
            dimmed[l] = dimming(lights[l], p, all);
            sent[l] = seen * arriving(lights[l], p) * std::exp(-dimmed[l].depth), local += sent[l];
        }
        total += pixels * square(local + seen * sun * std::exp(-p.to_light));
        Size& size = sizes_[binOf(wide, kBins)];
        const double of_all = pixels * square(local);
        size.part += of_all, size.projected += of_all * wide;
        for (size_t l = 0; l < lights.size(); ++l) {
            const double part = pixels * sent[l] * local; // (sum of R e)^2 <= (sum of R) (sum of R e^2)
            const double apart = glm::distance(p.centre, glm::dvec3(lights[l].position));
            const double bend = 1 / (square(std::max(apart - kBright * p.deviation, 0.0)) + square(p.deviation));
            Bend& bin = bends_[binOf(bend * square(unit), kBins)];
            bin.part += part, bin.bend += part * bend;
            directions += part * square(dimmed[l].directions), shells += part * square(dimmed[l].shells);
        }
    }
    // Right around a light nothing is before it, so that its volume errs nothing there: the others' mean counts.
    if (total > 0) directions_ = std::sqrt(directions / total), shells_ = std::sqrt(shells / total);
    for (const gpu::LocalLight& light : lights) {
        const glm::dvec3 at(light.position);
        const Local medium = mediumAt(at, scene.medium_sample.even());
        if (!(medium.extinction > 0) || !picture.holds(at)) continue;
        const glm::dvec3 to = at - picture.eye();
        const double distance = std::max(glm::length(to), kNear), wide = picture.pixel() * picture.depth(at);
        double before = 0;
        for (const SampledParticle& p : scene.medium_sample.even())
            before += depthBetween(p, at, -to / distance, distance, false);
        // A ray at distance h has pi sigma I / h of its light, down to a pixel's size or the light's own.
        const double least = std::max(double(light.radius), 0.5 * wide);
        const double radiance = medium.extinction * brightness(light.intensity) * std::exp(-before) / wide;
        const double part = 2 * square(kPi * radiance) * std::log(std::max(medium.length / least, 1.0));
        total += part;
        cores_.push_back({.length = medium.length, .projected = medium.length / wide, .part = part});
    }
    if (!(total > 0)) {
        // A few of many particles may be seen, and none of the sample: as mean ones.
        if (all.empty() || all.front().weight <= 1) return;
        bends_[bend_count_++] = {.bend = 1 / square(unit), .part = 1};
        sizes_[size_count_++] = {.projected = projectedDeviation(scene.extent, view), .part = 1};
        return;
    }
    for (Core& core : cores_) core.part /= total;
    bend_count_ = packed(bends_, &Bend::bend, total);
    size_count_ = packed(sizes_, &Size::projected, total);
}

} // namespace brume
