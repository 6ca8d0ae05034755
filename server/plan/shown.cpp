#include "server/plan/shown.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/inputs/eye_request.h"
#include "server/plan/work.h"

namespace brume {
namespace {

constexpr double kPi = std::numbers::pi;

double square(double x) { return x * x; }

} // namespace

ShownMedium::ShownMedium(const PlanScene& scene, const PlanView& view) {
    struct Seen {
        glm::dvec2 at;    // pixels
        double projected; // pixels of a deviation
        double radiance;  // at its centre, relative
        double share;     // part of it that is in the picture
        bool cut;         // True: the near plane may cut it
        double oblique;   // squared distance from the view axis and deviation over depth
    };
    const Frustum frustum = frustumOf(view.pose, view.width, view.height);
    const double pixel = (double(frustum.up) + double(frustum.down)) / double(view.height);
    const glm::dmat3 axes(glm::mat3_cast(view.pose.orientation));
    const glm::dvec3 eye(view.pose.position);
    // Part of at ± reach that lies between least and most.
    const auto part = [](double at, double reach, double least, double most) {
        const double lo = std::max(at - reach, least), hi = std::min(at + reach, most);
        return std::clamp((hi - lo) / (2 * reach), 0.0, 1.0);
    };
    const auto project = [&](glm::dvec3 centre, double deviation) {
        const glm::dvec3 to = centre - eye;
        const glm::dvec3 c(glm::dot(to, axes[0]), -glm::dot(to, axes[1]), -glm::dot(to, axes[2]));
        Seen s{};
        if (c.z + 2 * deviation <= double(kNearDepth)) return s;
        const double z = std::max({c.z, deviation, double(kNearDepth)});
        s.projected = deviation / (pixel * z);
        s.cut = c.z < 3.5 * deviation;
        s.at = glm::dvec2(c) / (pixel * z) + glm::dvec2(frustum.left, frustum.up) / pixel;
        s.share = part(s.at.x, 2 * s.projected, 0, view.width) * part(s.at.y, 2 * s.projected, 0, view.height);
        s.oblique = (c.x * c.x + c.y * c.y + deviation * deviation) / (z * z);
        return s;
    };
    const std::vector<SampledParticle> all = scene.medium_sample.seenIn([&](glm::dvec3 centre, double deviation) {
        const Seen s = project(centre, deviation);
        return s.share * square(s.projected);
    });
    std::vector<Seen> seen(all.size(), Seen{});
    double light = 0, light_depth = 0, crowding = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        const SampledParticle& p = all[i];
        Seen& s = seen[i] = project(p.centre, p.deviation);
        if (s.share <= 0) continue;
        const glm::dvec3 to = p.centre - eye;
        const double distance = std::max(glm::length(to), double(kNearDepth));
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
            const double others = all[j].weight - (i == j ? 1 : 0);
            if (!(b.radiance > 0) || others <= 0) continue;
            const double wide = square(a.projected) + square(b.projected) * std::pow(all[j].weight, 2.0 / 3);
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
