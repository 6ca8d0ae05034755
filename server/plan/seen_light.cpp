#include "server/plan/seen_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "server/inputs/eye_request.h"
#include "server/plan/work.h"

namespace brume {
namespace {

constexpr double kPi = std::numbers::pi;

double square(double x) { return x * x; }

// A particle in a picture: a Gaussian disc with this deviation.
struct Disc {
    glm::dvec2 at{0};     // pixels
    double deviation = 0; // pixels
    double radiance = 0;  // at its centre, for an irradiance of 1
    double share = 0;     // the part of it that is in the picture, out to two deviations
    bool reaches = false; // True: some of it may be in the picture, however faint
    bool cut = false;     // True: the near plane may cut it
    double oblique = 0;   // squared distance from the view axis and deviation, over squared depth
};

// Projects particles into one view's picture.
class Projection {
public:
    explicit Projection(const PlanView& view)
        : width_(view.width), height_(view.height), eye_(view.pose.position),
          axes_(glm::mat3_cast(view.pose.orientation)) {
        const Frustum frustum = frustumOf(view.pose, view.width, view.height);
        pixel_ = (double(frustum.up) + double(frustum.down)) / double(view.height);
        axis_ = glm::dvec2(frustum.left, frustum.up) / pixel_;
    }

    // Without its radiance. `deviation`: m. Of a particle behind the eye nothing is in the picture.
    Disc operator()(glm::dvec3 centre, double deviation) const {
        const glm::dvec3 to = centre - eye_;
        const glm::dvec3 c(glm::dot(to, axes_[0]), -glm::dot(to, axes_[1]), -glm::dot(to, axes_[2]));
        Disc disc;
        if (c.z + kFaint * deviation <= double(kNearDepth)) return disc;
        const double z = std::max({c.z, deviation, double(kNearDepth)});
        disc.deviation = deviation / (pixel_ * z);
        disc.cut = c.z < kReach * deviation;
        disc.at = glm::dvec2(c) / (pixel_ * z) + axis_;
        const auto shareOf = [&](double reach) {
            return part(disc.at.x, reach * disc.deviation, width_) * part(disc.at.y, reach * disc.deviation, height_);
        };
        if (c.z + 2 * deviation > double(kNearDepth)) disc.share = shareOf(2);
        disc.reaches = shareOf(kFaint) > 0;
        disc.oblique = (c.x * c.x + c.y * c.y + deviation * deviation) / (z * z);
        return disc;
    }
    glm::dvec3 eye() const { return eye_; }

private:
    static constexpr double kFaint = 5;   // deviations, to which a Gaussian is drawn
    static constexpr double kReach = 3.5; // deviations, beyond which a Gaussian has lost all but 0.05 % of its depth

    // The part of at ± reach that lies in 0 ... most.
    static double part(double at, double reach, double most) {
        const double lo = std::max(at - reach, 0.0), hi = std::min(at + reach, most);
        return std::clamp((hi - lo) / (2 * reach), 0.0, 1.0);
    }

    double width_, height_;
    glm::dvec3 eye_;
    glm::dmat3 axes_;
    double pixel_ = 0;   // m per m of view depth
    glm::dvec2 axis_{0}; // where the view axis meets the picture, pixels
};

// Single scattering at a particle's centre, with what lies before it toward the eye and toward the light:
//
//   L = (1 - exp(-tau)) exp(-tau_eye - tau_light)
double radianceOf(const SampledParticle& p, std::span<const SampledParticle> all, glm::dvec3 eye) {
    const glm::dvec3 to = p.centre - eye;
    const double distance = std::max(glm::length(to), double(kNearDepth));
    double before = 0;
    for (const SampledParticle& other : all)
        before += depthBetween(other, p.centre, -to / distance, distance, &other == &p);
    return -std::expm1(-p.depth) * std::exp(-before - p.to_light);
}

// Squared radiance, summed over pixels, of n_i particles like each disc i:
//
//   S = sum over i of  n_i a_i L_i^2 pi s_i^2   +   sum over pairs of  n_i n_j a_i L_i L_j G_ij
//   G_ij = 2 pi s_i^2 s_j^2 / w  exp(-d^2 / 2 w),   w = s_i^2 + s_j^2 n_j^(2/3)
//
// a: Disc::share; L: radiance; s: deviation, pixels; n: SampledParticle::weight.
// A disc's square has the integral pi s^2, and the product of two has G: with the deviation of one and of the cluster
// that the n_j others form, d pixels apart. Of a particle's own kind there are n_i - 1 others.
double squaredLight(std::span<const Disc> discs, std::span<const SampledParticle> all) {
    double sum = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        const Disc& a = discs[i];
        if (!(a.radiance > 0)) continue;
        const double n = all[i].weight;
        sum += n * a.share * square(a.radiance) * kPi * square(a.deviation);
        for (size_t j = 0; j < all.size(); ++j) {
            const Disc& b = discs[j];
            const double others = all[j].weight - (i == j ? 1 : 0);
            if (!(b.radiance > 0) || others <= 0) continue;
            const double wide = square(a.deviation) + square(b.deviation) * std::pow(all[j].weight, 2.0 / 3);
            const glm::dvec2 d = a.at - b.at;
            sum += n * others * a.share * a.radiance * b.radiance * 2 * kPi * square(a.deviation * b.deviation) / wide *
                   std::exp(-0.5 * glm::dot(d, d) / wide);
        }
    }
    return sum;
}

// How many times steeper a particle's outline is where little light comes: only its rim toward the light is seen. The
// factor is fitted to errors of balls of many depths.
double steepnessOf(double light_depth) { return std::sqrt(1 + 0.8 * std::log(std::max(light_depth, 1.0))); }

} // namespace

SeenLight::SeenLight(const PlanScene& scene, const PlanView& view) {
    const Projection project(view);
    const std::vector<SampledParticle> all = scene.medium_sample.seenIn([&](glm::dvec3 centre, double deviation) {
        const Disc disc = project(centre, deviation);
        return disc.share * square(disc.deviation);
    });
    std::vector<Disc> discs(all.size());
    double light = 0, light_depth = 0, crowding = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        const SampledParticle& p = all[i];
        Disc& disc = discs[i] = project(p.centre, p.deviation);
        if (disc.share <= 0) continue;
        disc.radiance = radianceOf(p, all, project.eye());
        const double sent = p.weight * disc.share * disc.radiance * square(disc.deviation);
        light += sent, light_depth += sent * p.to_light, crowding += sent * p.crowding;
    }
    const bool inside = isInside(scene.extent, view.pose.position);
    if (!(light > 0)) {
        // A few of many particles may be seen, and none of the sample; or of all the outermost alone. Then as a mean
        // one, off the axis.
        const auto reaches = [](const Disc& disc) { return disc.reaches; };
        if (all.empty() || (all.front().weight <= 1 && std::ranges::none_of(discs, reaches))) return;
        sizes_[count_++] = {.projected = projectedDeviation(scene.extent, view),
                            .deviation = double(scene.extent.deviation),
                            .part = 1,
                            .bend = 1,
                            .oblique = 0.1,
                            .cut = inside ? 1.0 : 0.0};
        return;
    }
    light_depth_ = light_depth / light;
    constexpr double kInside = 0.8; // factor for each optical depth, of an eye in the medium
    light_factor_ = std::max({std::sqrt(crowding / light), inside ? kInside * light_depth_ : 0, 1.0});
    const double squared = squaredLight(discs, all);
    for (size_t i = 0; i < all.size(); ++i) {
        const Disc& disc = discs[i];
        if (disc.radiance > 0)
            add(all[i], disc.deviation / steepnessOf(all[i].to_light),
                {.part = all[i].weight * disc.share * square(disc.radiance) * kPi * square(disc.deviation) / squared,
                 .oblique = disc.oblique,
                 .cut = disc.cut ? 1.0 : 0.0,
                 .light = all[i].weight * disc.share * disc.radiance * square(disc.deviation) / light},
                double(scene.extent.deviation));
    }
    takeMeans();
}

// Adds a particle to the sums of its size. Errors grow with about the sixth power of the samples' distance in
// deviations, so deviations have a power mean with the exponent -6.
void SeenLight::add(const SampledParticle& p, double outline, const Size& one, double mean_deviation) {
    const double bin = 2 * std::log2(p.deviation / mean_deviation) + kSizes / 2.0; // half an octave each
    Size& size = sizes_[size_t(std::clamp(bin, 0.0, double(kSizes - 1)))];
    size.projected += one.part * std::pow(outline, -6);
    size.deviation += one.part * std::pow(p.deviation, -6);
    size.part += one.part;
    size.bend += one.part * square(bendOf(std::sqrt(2 * kPi) * p.deviation * p.extinction));
    size.oblique += one.part * square(one.oblique);
    if (one.cut > 0) size.cut += one.part;
    size.light += one.light;
    size.extinction += one.light * square(p.extinction);
}

// From sums to means, of the sizes that there are. They move to the front.
void SeenLight::takeMeans() {
    for (const Size size : sizes_) {
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

double SeenLight::bendOf(double depth) { return std::min(depth, 1.0) * std::pow(1 + depth / 12, 0.9); }

} // namespace brume
