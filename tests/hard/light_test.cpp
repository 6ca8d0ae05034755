// Light from hard directions, through walls' edges, and phase functions that are nearly a mirror.
#include <algorithm>
#include <cmath>

#include "shaders/shared/phase.h"
#include "tests/hard/hard.h"
#include "tests/layer.h"

namespace brume::test::light_test {
namespace {

constexpr uint32_t kWidth = 65, kHeight = 49; // odd: one pixel looks straight ahead

// What linear interpolation in the shadow volume gets wrong of a light depth, with so many texels and planes to 1/k:
// h^2/8 of second derivatives of at most 2 k^2 tau in two directions and 0.49 k^2 tau along the light.
double interpolation(double depth, double texels, double planes) {
    return depth * (4 / (texels * texels) + 0.49 / (planes * planes)) / 8;
}

// Henyey and Greenstein's peak at g = +-.9999, where it is 10^8 times its other end. Naive: 1 + g^2 - 2 g cosine
// cancels. (No Schlick phase function is in the code; its k would need a clamp above g = .938.)
TEST_F(HardTest, PhaseAtAsymmetry9999InFloat) {
    double stable = 0, naive = 0;
    for (const float g : {0.9999f, -0.9999f})
        for (double angle = 0; angle < 0.01; angle += 2e-5) {
            const glm::vec3 in = glm::normalize(glm::vec3(0.3f, -0.8f, 0.52f));
            const glm::vec3 across = glm::normalize(glm::cross(in, glm::vec3(0.1f, 0.2f, 0.97f)));
            const glm::vec3 out =
                (g < 0 ? -1.0f : 1.0f) * (float(std::cos(angle)) * in + float(std::sin(angle)) * across);
            // In double for the same rounded numbers: their own rounding is the caller's.
            const double exact = physics::phaseHenyeyGreenstein(glm::dvec3(in), glm::dvec3(out), double(g));
            stable = worse(stable, std::abs(double(physics::phaseHenyeyGreenstein(in, out, g)) / exact - 1));
            const float d = 1 + g * g - 2 * g * glm::dot(in, out);
            naive = std::max(naive,
                             std::abs(double((1 - g * g) / (float(4 * kPi) * d * std::sqrt(std::abs(d)))) / exact - 1));
        }
    // The differences of neighbours and 1 - |g| are exact; ten roundings remain, half of them in an exponent of 3/2.
    judge("g = +-.9999 into the light, closed form in float: relative", "all", stable, 2e-6);
    EXPECT_FALSE(naive < 0.5) << "the naive form was expected to fail";
}

// A scene's limit, g = +-.99, through the whole renderer. The light is in view: the peak too.
TEST_F(HardTest, LookingIntoTheLight) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = sceneOf(randomPoints(40, 6, 2, 0.6f), 1.6f);
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.01f, 0.02f, -1));
    const Pose pose = lookAt({0, 0, 9}, {0, 0, 0}, 0.3f);
    const glm::dvec3 to_light = glm::normalize(glm::dvec3(scene.lights[0].to_light));
    for (const Way& way : waysAndSampled()) {
        choose(scene, way);
        scene.medium.anisotropy = 0;
        const Picture isotropic = plain().see(scene, pose, kWidth, kHeight);
        for (const float g : {0.99f, -0.99f}) {
            scene.medium.anisotropy = 1;
            scene.medium.asymmetry = g;
            double error = 0, largest = 0;
            forPixels(plain().see(scene, pose, kWidth, kHeight), pose,
                      [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
                          const glm::dvec3 apart =
                              g < 0 ? to_light + ray.w : to_light - ray.w; // light travels along -to_light, then -w
                          const double size = std::abs(double(g)),
                                       d = (1 - size) * (1 - size) + size * glm::dot(apart, apart);
                          const double ratio = (1 - size) * (1 + size) / (d * std::sqrt(d));
                          error = worse(error, std::abs(got.r / (double(isotropic.at(x, y).r) * ratio) - 1));
                          largest = std::max(largest, ratio);
                      });
            // Directions err by 1.2e-7, which 1.5 * 2 apart / d amplifies: at most 1.5 / (1 - g).
            judge("g = +-.99 into the light: radiance against the isotropic one's, relative", way, error,
                  1.5e2 * 1.2e-7 + 1e-5);
            if (g > 0) {
                EXPECT_GT(largest, 1e4) << "the peak is not in view";
            }
        }
    }
}

// Naive: a wall's depth test drops the whole particle, or none of it.
TEST_F(HardTest, AWallThroughAParticle) {
    Scene wall = sceneOf({Point{}});
    wall.boxes = {{{0, 0, -1}, {40, 40, 2}, 0, glm::vec3(0)}}; // black, its front at z = 0
    Stage stage(device(), wall, 1);
    const Pose pose = lookAt({0, 0, 7}, {0, 0, 0}, 0.5f);
    for (const Way& way : waysAndSampled())
        for (const float falloff : {1.6f, kInside}) {
            Scene scene = sceneOf({thick({0, 0, 0}, 2, 2, falloff)}, falloff);
            scene.boxes = wall.boxes;
            choose(scene, way);
            const reference::Blob blob = blobsOf(scene)[0];
            double error = 0, middle = 0;
            forPixels(stage.see(scene, pose, kWidth, kHeight), pose,
                      [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
                          Interval interval = supportOf(way, blob, ray);
                          interval.end = std::min(interval.end, -ray.eye.z / ray.w.z);
                          error = worse(error, std::abs(got.a - std::exp(-depthOn(blob, ray, interval))));
                          if (x == kWidth / 2 && y == kHeight / 2) middle = got.a;
                      });
            // Silhouettes drawn to 1/256 pixel where the Gaussian is cut, or to what rounding() says: of a slope of
            // 0.04 a pixel at most.
            judge("wall through a particle: transmittance of what is in front", way, error,
                  isCut(way) && falloff > kInside ? 2e-4 + 0.04 * rounding() : allowed(7, blob.k, 2));
            const Ray ahead{pose.position, {0, 0, -1}, kNearDepth};
            judge("wall through a particle: transmittance of exactly half", way,
                  std::abs(middle - std::exp(-depthOn(blob, ahead, supportOf(way, blob, ahead)) / 2)), 3e-6);
        }
}

// The edge of a shadow through the middle of one particle, in a plane that holds the view: every ray is lit or dark
// from end to end. Naive: one visibility per particle, and the whole of it is lit or dark.
TEST_F(HardTest, ASharpShaftInsideOneParticle) {
    Scene open = sceneOf({thick({0, 0, 0}, 2, 1, kInside)}, kInside);
    open.lights[0].to_light = {0, 1, 0};
    Scene scene = open;
    scene.boxes = {{{-5, 5, 0}, {10, 1, 30}, 0, glm::vec3(0)}}; // black, above everything with x < 0
    scene.render.opaque_shadow_size = 4096;
    Stage stage(device(), scene, 1);
    const Pose pose = lookAt({0, 0, 40}, {0, 0, 0}, 0.012f); // nearly parallel rays
    const double texel = 30.0 / 4096;
    for (const Way& way : waysAndSampled()) {
        choose(scene, way);
        choose(open, way);
        const Picture lit = plain().see(open, pose, kWidth, kHeight);
        float brightest = 0;
        for (const glm::vec4& pixel : lit.pixels) brightest = std::max(brightest, pixel.r);
        double error = 0;
        int dark = 0, bright = 0;
        forPixels(stage.see(scene, pose, kWidth, kHeight), pose,
                  [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
                      const double at = ray.w.x / -ray.w.z * 40; // x where the ray passes the particle's centre
                      if (std::abs(at) < 3 * texel) return;      // the shadow map's texels end the shaft
                      const double exact = at < 0 ? 0 : double(lit.at(x, y).r);
                      error = worse(error, std::abs(got.r - exact) / double(brightest));
                      (at < 0 ? dark : bright) += double(lit.at(x, y).r) > 0.1 * double(brightest);
                  });
        EXPECT_GT(dark, 100);
        EXPECT_GT(bright, 100);
        judge("sharp shaft inside one particle: radiance, of the brightest", way, error,
              1e-5); // two pipelines' roundings
    }
}

// Naive: builds the light's axes from a cross product with +Y, and divides by 0.
TEST_F(HardTest, LightAlongYUpAndDown) {
    const Pose pose = lookAt({0.5f, 1, 7}, {0, 0, 0}, 0.12f);
    for (const glm::vec3 to_light : {glm::vec3(0, 1, 0), glm::vec3(0, -1, 0), glm::vec3(1e-4f, 1, 0)}) {
        Scene scene = sceneOf({thick({0, 0, 0}, 2, 1, kInside)}, kInside);
        scene.lights[0].to_light = glm::normalize(to_light);
        scene.lights[0].irradiance = glm::vec3(float(4 * kPi));
        scene.render.shadow_slices = 128;
        const auto blobs = blobsOf(scene);
        const reference::LightField field(blobs, glm::normalize(glm::dvec3(scene.lights[0].to_light)));
        for (const Way& way : waysAndSampled()) {
            choose(scene, way);
            double error = 0, largest = 0;
            forPixels(plain().see(scene, pose, kWidth, kHeight), pose,
                      [&](glm::dvec4 got, const Ray& ray, uint32_t x, uint32_t y) {
                          const auto lit = [&](Interval inside) {
                              return scatteredBy(way, blobs[0], ray, inside,
                                                 [&](glm::dvec3 at) { return field.depth(at); });
                          };
                          const double rule = lit(supportOf(way, blobs[0], ray));
                          // Simpson's nodes move with the interval's ends.
                          const double elsewhere = drawnElsewhere(way, blobs[0], pose, kWidth, kHeight, x, y, lit);
                          error = worse(error, std::abs(got.r - rule) - elsewhere);
                          largest = std::max(largest, rule);
                      });
            EXPECT_GT(largest, 0.1);
            judge("light along +Y and -Y: radiance, of the brightest", way, error / largest,
                  ruleError(way) + interpolation(1, 30, 15) + 1e-4);
        }
    }
}

// What lies below the medium gets the light that is left, however coarse the volume: its last plane holds the whole
// depth. Naive: the seed puts a particle's whole depth into the slice of its front; outside the volume, nothing.
TEST_F(HardTest, ParticlesLargerThanASliceAndGroundOutsideTheVolume) {
    Scene scene = sceneOf({thick({0, 30, 0}, 6, 2.2, 1.6f)}, 1.6f);
    scene.planes = {{0, glm::vec3(0.5f)}};
    scene.render.shadow_size = 512;
    const glm::vec3 to_light = scene.lights[0].to_light,
                    below = -30 / to_light.y * glm::vec3(to_light.x, 0, to_light.z);
    const Pose pose = lookAt(below + glm::vec3(1, 9, 6), below, 1.2f); // the medium is overhead
    const auto blobs = blobsOf(scene);
    const reference::LightField field(blobs, to_light);
    Stage stage(device(), scene, 1);
    for (const Way& way : waysAndSampled())
        for (const uint32_t slices : {2u, 3u, 16u, 128u}) {
            choose(scene, way);
            scene.render.shadow_slices = slices;
            double error = 0, darkest = 1;
            forPixels(stage.see(scene, pose, kWidth, kHeight), pose,
                      [&](glm::dvec4 got, const Ray& ray, uint32_t, uint32_t) {
                          const double through = std::exp(-field.depth(ray.at(-ray.eye.y / ray.w.y)));
                          const double open = 0.5 * double(to_light.y) / kPi;
                          error = worse(error, std::abs(got.r / open - through));
                          darkest = std::min(darkest, through);
                      });
            EXPECT_LT(darkest, 0.12);
            // Bilinear texels of 1/67 of 1/k; planes play no part below the last.
            judge("particle larger than a slice, ground outside the volume: light that is left", way, error,
                  2.3 * 4 / (67.0 * 67 * 8));
        }
}

// The same inside the medium: a thin particle in the shadow of another, planes farther apart than either is large.
TEST_F(HardTest, AParticleInTheShadowOfOneSmallerThanASlice) {
    const double faint = 1e-3; // its own shadow is nothing to speak of
    Scene scene = sceneOf(
        {thick({0, 8, 0}, 8, 2, kInside), thick({0, 0, 0}, 1, faint, kInside), thick({0, -9, 0}, 1, faint, kInside)},
        kInside);
    scene.lights[0].to_light = {0, 1, 0};
    scene.lights[0].irradiance = glm::vec3(float(4 * kPi));
    const Pose pose = lookAt({0, 0, 7}, {0, 0, 0}, 0.01f);
    const auto blobs = blobsOf(scene);
    const reference::LightField field(blobs, {0, 1, 0});
    for (const uint32_t slices : {4u, 8u, 16u}) { // planes 6.3, 2.7 and 1.3 m apart; the first one's 1/k is 0.34 m
        scene.render.shadow_slices = slices;
        for (const Way& way : waysAndSampled()) {
            choose(scene, way);
            double error = 0;
            forPixels(plain().see(scene, pose, 5, 5), pose, [&](glm::dvec4 got, const Ray& ray, uint32_t, uint32_t) {
                const double rule = scatteredBy(way, blobs[1], ray, [&](glm::dvec3 at) { return field.depth(at); });
                error = worse(error, std::abs(got.r / rule - 1));
            });
            // Texels of 1/31 of the first one's 1/k; and its own shadow, which such planes blur.
            judge("particle in the shadow of another, less than a slice each: radiance, relative", way, error,
                  ruleError(way) + interpolation(2, 31, 1e9) + faint + 1e-4);
        }
    }
}

} // namespace
} // namespace brume::test::light_test
