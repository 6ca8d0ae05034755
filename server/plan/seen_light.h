// What a picture shows of the medium, from a sample of its particles: how much of its light comes from particles of
// which size and depth. Laws of errors are sums over that.
#pragma once

#include <array>
#include <cstddef>
#include <span>

namespace brume {

struct PlanScene;
struct PlanView;
struct SampledParticle; // server/plan/medium_sample.h

// Light of one view by the size of the particles that it comes from. Parts are of the sum over the medium's pixels of
// squared radiance: an error that differs from particle to particle adds up to the root of a sum of part * error^2.
class SeenLight {
public:
    SeenLight(const PlanScene& scene, const PlanView& view);

    struct Size {
        double projected = 0;  // pixels of a deviation, less where little light comes: outlines are steeper there
        double deviation = 0;  // m
        double part = 0;       // sum of parts
        double bend = 0;       // mean of bendOf(), root mean square
        double oblique = 0;    // squared distance from the view axis and deviation, over squared depth; the same
        double cut = 0;        // sum of parts of those that the near plane may cut
        double light = 0;      // part of the light that reaches the eye
        double extinction = 0; // 1/m, of the whole medium there, root mean square by light
    };
    // Sizes that have particles, small ones first. Where no particle of the sample is seen there is none, or a mean one
    // if each of the sample stands for several.
    std::span<const Size> sizes() const { return {sizes_.data(), count_}; }
    // Mean optical depth between what is seen and the light, weighted by the light that it sends to the eye.
    double lightDepth() const { return light_depth_; }
    // Factor, at least 1, of the volumetric shadow map's estimate of its error: more where particles crowd, and for
    // eyes in a dense medium.
    double lightFactor() const { return light_factor_; }

    // How much light varies within a deviation's length of this optical depth.
    static double bendOf(double depth);

private:
    static constexpr size_t kSizes = 24;

    // `outline`: deviation of the particle's outline, pixels. `one`: what it adds of part, oblique, cut and light.
    // `mean_deviation`: of the medium, m.
    void add(const SampledParticle& p, double outline, const Size& one, double mean_deviation);
    void takeMeans();

    std::array<Size, kSizes> sizes_{};
    size_t count_ = 0;
    double light_depth_ = 0, light_factor_ = 1;
};

} // namespace brume
