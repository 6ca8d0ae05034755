// HardTest, base of the hard cases: all ways to render, the exact result for each, and the table of measured errors.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/gpu/closed_form.h"

namespace brume::test {

// One way to render: a method and, if it has several, a quadrature.
struct Way {
    std::string method, quadrature;
    uint32_t steps;
    std::string name() const; // "isv, simpson-2"
};

// Every method with a closed form, with each of its quadratures.
std::vector<Way> allWays();
// Methods that take samples of medium and light along a ray, which no closed form describes. Each case that they are
// drawn with has bars of their own (sampled_bars.cpp).
std::vector<Way> sampledWays();
bool isSampled(const Way& way);
// The largest error that such a method may have in a case. kCannot: it cannot draw it, for the reason `why`.
inline constexpr double kCannot = -1;
struct SampledBar {
    double most;
    const char* why = "";
};
// Throws std::out_of_range for a case without bars.
SampledBar barOf(const std::string& hard_case, const Way& way);
void choose(Scene& scene, const Way& way);

// The part of a ray on which a way integrates a particle: for isv inside its tetrahedron, for others the whole ray.
// isCut(): true for isv.
bool isCut(const Way& way);
Interval supportOf(const Way& way, const reference::Blob& blob, const Ray& ray);

// A falloff at which every way integrates the whole Gaussian: a face of the tetrahedron is 7.9 / k from the centre,
// and cuts off less than 1e-27 of the optical depth.
inline constexpr float kInside = 0.3f;

// The integral of sigma T_V T_L over the support, by the way's own quadrature in double precision. A picture differs
// from it only by float32 and by the shadow volume. For a method without a rule here it is the exact integral.
// `light_depth`: optical depth from a place to the light.
double scatteredBy(const Way& way, const reference::Blob& blob, const Ray& ray,
                   const std::function<double(glm::dvec3)>& light_depth);
double scatteredBy(const Way& way, const reference::Blob& blob, const Ray& ray, Interval inside,
                   const std::function<double(glm::dvec3)>& light_depth);
// Relative error that a way may have against scatteredBy() in exact arithmetic; 0 if scatteredBy() uses its rule.
double ruleError(const Way& way);

class HardTest : public GpuTest {
protected:
    // The ways that a case is drawn by: all in the whole layer, and for the table. In the quick layer slabs, grid and
    // one of the others, another one for each case.
    static std::vector<Way> ways();
    // The same and sampledWays(), of which the quick layer takes one, another one for each case.
    static std::vector<Way> waysAndSampled();

    // Expects error <= tolerance and adds a row to the table. Of several rows with the same name, the one with the
    // largest error / tolerance is kept.
    static void judge(const std::string& hard_case, const std::string& way, double error, double tolerance);
    static void judge(const std::string& hard_case, const Way& way, double error, double tolerance) {
        if (!isSampled(way)) return judge(hard_case, way.name(), error, tolerance);
        const SampledBar bar = barOf(hard_case, way);
        if (bar.most == kCannot) return note(hard_case, way, bar.why);
        judge(hard_case, way.name(), error, bar.most);
    }

    // True if the way refuses the scene with its settings. The table then gets a row with the reason instead of an
    // error.
    static bool refused(const std::string& hard_case, const Way& way, const Scene& scene);

    // Adds a row with the reason why a way has no error in a case.
    static void note(const std::string& hard_case, const Way& way, const std::string& why);

    // Steps, in pixels, to which the device rounds the vertices of what it draws, less the 1/256 that every tolerance
    // allows for.
    static double rounding();
    // The largest change of value(interval) if a pixel looks up its interval where the device may have drawn it.
    //
    // Each vertex of isv's proxy is up to rounding() away from its place. A pixel is a mean of its triangle's vertices,
    // so it is no farther away from where its interval belongs. 0 on a device that rounds to 1/256 pixel, for ways that
    // draw no intervals, and for a particle that the near plane crosses: its interval comes from its faces.
    static double drawnElsewhere(const Way& way, const reference::Blob& blob, const Pose& pose, uint32_t width,
                                 uint32_t height, uint32_t x, uint32_t y, const std::function<double(Interval)>& value);

    // Calls check(pixel, ray, x, y) for every pixel.
    template <class Check>
    static void forPixels(const Picture& picture, const Pose& pose, const Check& check) {
        for (uint32_t y = 0; y < picture.height; ++y)
            for (uint32_t x = 0; x < picture.width; ++x)
                check(glm::dvec4(picture.at(x, y)), rayThrough(pose, picture.width, picture.height, x, y), x, y);
    }

    struct Seen {
        double error = 0;  // largest error of a transmittance; NaN if any number is not finite
        double lowest = 1; // least exact transmittance
        int covered = 0;   // number of pixels that see medium
    };
    // Compares every pixel's transmittance with the exact one of the scene's particles on its ray. The rasterizer
    // rounds vertices to 1/256 pixel, or to what rounding() says. For ways that cut the Gaussian at faces, the error
    // that this explains is subtracted. `stride`: compares only every so many-th pixel; all others must still be
    // finite.
    static Seen transmittance(Stage& stage, Scene scene, const Way& way, const Pose& pose, uint32_t width,
                              uint32_t height, uint32_t stride = 1);
};

// The larger of the two; NaN if either is.
double worse(double a, double b);

// Number of pixels whose bits differ.
int differing(const Picture& a, const Picture& b);

} // namespace brume::test
