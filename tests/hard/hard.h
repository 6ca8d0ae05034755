// What the hard cases share: every way to render, what each is compared with, and the table of what was measured.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/gpu/closed_form.h"

namespace brume::test {

// One way to render: a method, and where it can choose, its quadrature.
struct Way {
    std::string method, quadrature;
    uint32_t steps;
    std::string name() const; // "isv, simpson-2"
};

// Every method that the renderer has, with every quadrature that it has.
std::vector<Way> ways();
void choose(Scene& scene, const Way& way);

// The part of a ray on which a way sees a particle: isv what lies in its tetrahedron, others the whole Gaussian.
bool isCut(const Way& way);
Interval supportOf(const Way& way, const reference::Blob& blob, const Ray& ray);

// With this falloff a face of the tetrahedron is 7.9 / k from the centre: what it cuts off is below 1e-27 of the optical depth,
// and every way sees the whole Gaussian.
inline constexpr float kInside = 0.3f;

// The integral of sigma T_V T_L over the support, by the way's own rule in double precision: a picture differs from it by float32
// and by the shadow volume alone. For a method without a rule here: the integral itself.
// `light_depth` is of a place.
double scatteredBy(const Way& way, const reference::Blob& blob, const Ray& ray,
                   const std::function<double(glm::dvec3)>& light_depth);
// Relative error that a way may have against scatteredBy() in exact arithmetic: 0 where its rule is known.
double ruleError(const Way& way);

class HardTest : public GpuTest {
protected:
    // Expects error <= tolerance and keeps the row for the table; of several with one name, the worst compared with its
    // tolerance.
    static void judge(const std::string& hard_case, const std::string& way, double error, double tolerance);
    static void judge(const std::string& hard_case, const Way& way, double error, double tolerance) {
        judge(hard_case, way.name(), error, tolerance);
    }

    // Whether the way refuses the scene, with the settings that it has: a row of the table, with the reason instead of an error.
    static bool refused(const std::string& hard_case, const Way& way, const Scene& scene);

    // check(pixel, ray, x, y) for every pixel.
    template <class Check>
    static void forPixels(const Picture& picture, const Pose& pose, const Check& check) {
        for (uint32_t y = 0; y < picture.height; ++y)
            for (uint32_t x = 0; x < picture.width; ++x)
                check(glm::dvec4(picture.at(x, y)), rayThrough(pose, picture.width, picture.height, x, y), x, y);
    }

    struct Seen {
        double error = 0;  // largest, of the transmittance; NaN if any number of the picture is not finite
        double lowest = 1; // exact transmittance
        int covered = 0;   // pixels
    };
    // Every pixel's transmittance against that of the exact optical depth of the scene's particles on its ray. Vertices are drawn
    // rounded to 1/256 pixel: where faces cut the Gaussian, what that explains is subtracted from the error.
    // `stride`: only every so many-th pixel (the rest must be finite).
    static Seen transmittance(Stage& stage, Scene scene, const Way& way, const Pose& pose, uint32_t width, uint32_t height,
                              uint32_t stride = 1);
};

// The larger of the two; NaN if either is.
double worse(double a, double b);

// Number of pixels whose bits differ.
int differing(const Picture& a, const Picture& b);

} // namespace brume::test
