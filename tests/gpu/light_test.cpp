// The opaque shadow map texel by texel against double precision, and what surfaces and medium get of it.
#include <algorithm>
#include <cmath>

#include "server/effects/object_shadow/opaque_shadow.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/light_passes.h"
#include "tests/gpu/quadrature.h"

namespace brume::test::light_test {
namespace {

// Height along to_light at which a light ray through a point of light space first meets a box, below -1e29 when it
// misses.
double heightOfBox(const Box& box, const gpu::Tick& tick, glm::dvec2 at) {
    const double c = std::cos(double(box.yaw)), s = std::sin(double(box.yaw));
    const auto toBox = [&](glm::dvec3 v) { return glm::dvec3(c * v.x - s * v.z, v.y, s * v.x + c * v.z); };
    const glm::dvec3 origin = toBox(fromLightSpace(tick, {at, 0.0}) - glm::dvec3(box.centre)),
                     up = toBox(tick.sun.to_light);
    double bottom = -1e30, top = 1e30;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (-0.5 * double(box.size[axis]) - origin[axis]) / up[axis],
                     b = (0.5 * double(box.size[axis]) - origin[axis]) / up[axis];
        bottom = std::max(bottom, std::min(a, b));
        top = std::min(top, std::max(a, b));
    }
    return top > bottom ? top : -1e30;
}

double heightOfSphere(const Sphere& sphere, const gpu::Tick& tick, glm::dvec2 at) {
    const glm::dvec3 off = glm::dvec3(sphere.centre) - fromLightSpace(tick, {at, 0.0});
    const double along = glm::dot(off, glm::dvec3(tick.sun.to_light)), r = double(sphere.radius);
    const double half_squared = r * r - glm::dot(off, off) + along * along;
    return half_squared > 0 ? along + std::sqrt(half_squared) : -1e30;
}

TEST_F(GpuTest, OpaqueShadowMapHoldsTheHeightsOfTheTopmost) {
    Scene scene = sceneOf({Point{}});
    scene.planes = {{-3, glm::vec3(0.5f)}}; // casts nothing
    scene.boxes = {{{1, 2, 0}, {3, 0.5f, 1}, 0.7f, glm::vec3(0.5f)},
                   {{-2, -1, 1}, {1, 2, 1.5f}, -0.3f, glm::vec3(0.5f)}};
    scene.spheres = {{{0, 0.5f, 2}, 1.2f, glm::vec3(0.5f)}, {{1.5f, 4, 0}, 0.4f, glm::vec3(0.5f)}};
    OpaqueShadow shadow(device());
    for (const uint32_t size : {37u, 256u})
        for (const glm::vec3 to_light :
             {glm::vec3(0.3f, 0.8f, 0.5f), glm::vec3(-0.9f, 0.3f, 0.1f), glm::vec3(0.001f, 1, 0.002f)}) {
            scene.lights[0].to_light = glm::normalize(to_light);
            scene.render.opaque_shadow_size = size;
            const gpu::Tick tick = tickOf(scene, {});
            recordAndWait(device(), tick, "Objects", opaqueObjects(scene),
                          [&](gpu::Commands& commands, gpu::Resources& shared) {
                              shadow.record(commands, shared, tick, opaqueObjects(scene));
                          });
            const std::vector<float> map = readImage(device(), shadow.image(), 1);
            const auto height = [&](glm::dvec2 at) {
                double top = -1e30;
                for (const Box& box : scene.boxes) top = std::max(top, heightOfBox(box, tick, at));
                for (const Sphere& sphere : scene.spheres) top = std::max(top, heightOfSphere(sphere, tick, at));
                return top;
            };
            size_t covered = 0, unclear = 0;
            for (uint32_t y = 0; y < size; ++y)
                for (uint32_t x = 0; x < size; ++x) {
                    const glm::dvec2 at = glm::mix(glm::dvec2(tick.map.opaque_lo), glm::dvec2(tick.map.opaque_hi),
                                                   (glm::dvec2(x, y) + 0.5) / double(size));
                    constexpr double kNothing = -1e6; // what lies below counts as this
                    const double exact = std::max(height(at), kNothing),
                                 got = std::max(double(map[y * size + x]), kNothing);
                    double change = 0; // within a tenth of a millimetre
                    for (const glm::dvec2 d :
                         {glm::dvec2(1e-4, 0), glm::dvec2(-1e-4, 0), glm::dvec2(0, 1e-4), glm::dvec2(0, -1e-4)})
                        change = std::max(change, std::abs(std::max(height(at + d), kNothing) - exact));
                    if (change > 0.1) {
                        ++unclear; // a silhouette
                        continue;
                    }
                    ASSERT_NEAR(got, exact, 1e-5 + 0.1 * change) << x << ' ' << y; // as if places erred by 1e-5 m
                    covered += exact > kNothing;
                    if (x == 0 || y == 0 || x == size - 1 || y == size - 1) {
                        EXPECT_EQ(got, kNothing) << "the rim is not empty";
                    }
                }
            EXPECT_GT(covered, size * size / 20);
            EXPECT_LT(unclear, size * size / 200);
        }
}

// --- what surfaces get ---

constexpr uint32_t kWidth = 80, kHeight = 60;

TEST_F(GpuTest, GroundLiesInTheShadowOfTheMedium) {
    Scene scene = sceneOf({Point{{0, 30, 0}, 6, 0.9f}}, 1.6f); // central optical depth 2.2
    scene.planes = {{0, {0.5f, 0.4f, 0.3f}}};
    scene.lights[0].irradiance = {2, 3, 4};
    scene.render.shadow_size = 512;
    const glm::vec3 to_light = scene.lights[0].to_light,
                    middle = -30 / to_light.y * glm::vec3(to_light.x, 0, to_light.z);
    const Pose pose = lookAt(middle + glm::vec3(1, 9, 6), middle, 1.2f); // the medium is overhead
    const Picture picture = render(device(), scene, pose, kWidth, kHeight);
    const auto blobs = blobsOf(scene);
    const reference::LightField field(blobs, to_light);
    double darkest = 1;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
            const double through = std::exp(-field.depth(ray.at(-ray.eye.y / ray.w.y)));
            // Bilinear texels of 1/67 of 1/k: h^2/8 of the second derivative 2 k^2 tau, in two directions.
            const double error = 2.3 * 4 / (67.0 * 67 * 8);
            for (int c = 0; c < 3; ++c) {
                const double open =
                    double(scene.planes[0].albedo[c] * scene.lights[0].irradiance[c] * to_light.y) / kPi;
                ASSERT_NEAR(double(picture.at(x, y)[c]), open * through, open * error) << x << ' ' << y;
            }
            ASSERT_EQ(picture.at(x, y).a, 1);
            darkest = std::min(darkest, through);
        }
    EXPECT_LT(darkest, 0.12);
}

TEST_F(GpuTest, GroundAndFacesUnderABoxAndASphere) {
    Scene scene = sceneOf({Point{{0, -50, 0}, 1, 0}}); // no medium
    scene.planes = {{0, glm::vec3(0.5f)}};
    scene.boxes = {{{0, 2, 0}, {0.4f, 0.6f, 9}, 0.6f, glm::vec3(0.25f)}};
    scene.spheres = {{{-3, 1.5f, 1}, 1, glm::vec3(0.75f)}};
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.5f, 0.6f, 0.25f));
    const glm::dvec3 to_light(scene.lights[0].to_light);
    const gpu::Tick tick = tickOf(scene, {});
    const Pose pose = lookAt({3, 9, 9}, {-1, 0, -0.5f}, 0.9f);
    const uint32_t width = 160, height = 120;
    const Picture picture = render(device(), scene, pose, width, height);

    // What a ray meets: the object's number (0: ground) and the light that its surface would get unshadowed.
    struct Hit {
        int object;
        double cosine;
        glm::dvec3 x;
    };
    const Box& box = scene.boxes[0];
    const auto trace = [&](double px, double py) -> Hit {
        const glm::dvec3 w = glm::normalize(glm::dquat(pose.orientation) *
                                            glm::dvec3((px / width * 2 - 1) * std::tan(0.45) * width / height,
                                                       (1 - py / height * 2) * std::tan(0.45), -1));
        const glm::dvec3 eye(pose.position);
        double nearest = -eye.y / w.y;
        Hit hit{0, to_light.y, eye + nearest * w};
        const double c = std::cos(double(box.yaw)), s = std::sin(double(box.yaw));
        const auto toBox = [&](glm::dvec3 v) { return glm::dvec3(c * v.x - s * v.z, v.y, s * v.x + c * v.z); };
        const glm::dvec3 o = toBox(eye - glm::dvec3(box.centre)), d = toBox(w), l = toBox(to_light);
        double enter = -1e30, leave = 1e30;
        int face = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double a = (-0.5 * double(box.size[axis]) - o[axis]) / d[axis],
                         b = (0.5 * double(box.size[axis]) - o[axis]) / d[axis];
            if (std::min(a, b) > enter) enter = std::min(a, b), face = axis;
            leave = std::min(leave, std::max(a, b));
        }
        if (enter < leave && enter < nearest) {
            nearest = enter;
            hit = {1 + face, d[face] > 0 ? -l[face] : l[face], eye + enter * w};
        }
        const Sphere& sphere = scene.spheres[0];
        const glm::dvec3 off = glm::dvec3(sphere.centre) - eye;
        const double along = glm::dot(off, w), half_squared = 1 - glm::dot(off, off) + along * along;
        if (half_squared > 0 && along - std::sqrt(half_squared) < nearest) {
            nearest = along - std::sqrt(half_squared);
            const glm::dvec3 x = eye + nearest * w;
            hit = {4, glm::dot(x - glm::dvec3(sphere.centre), to_light), x};
        }
        return hit;
    };
    // Whether light reaches a point past both, seen from `tolerance` (m) around it: 0, 1, or neither.
    const auto visibility = [&](glm::dvec3 x, double tolerance) {
        const glm::dvec2 at(glm::dot(x, glm::dvec3(tick.map.x)), glm::dot(x, glm::dvec3(tick.map.y)));
        const double height_of_x = glm::dot(x, to_light);
        double sum = 0;
        for (int i = 0; i < 8; ++i) {
            const glm::dvec2 near = at + tolerance * glm::dvec2(std::cos(i * kPi / 4), std::sin(i * kPi / 4));
            const double top = std::max(heightOfBox(box, tick, near), heightOfSphere(scene.spheres[0], tick, near));
            sum += top <= height_of_x + 1e-9 + 2 * tolerance ? 1 : 0; // of its own surface: within the tolerance
        }
        return sum / 8;
    };
    const double texel = glm::length(glm::dvec2(tick.map.opaque_hi - tick.map.opaque_lo)) / tick.map.opaque_size;
    int seen[5] = {}, shadowed = 0;
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const Hit hit = trace(x + 0.5, y + 0.5);
            bool edge = false; // smoothed over the pixel
            for (const glm::dvec2 corner : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(1, 1)})
                edge = edge || trace(x + corner.x, y + corner.y).object != hit.object;
            if (edge || (hit.cosine > 0 && hit.cosine < 0.15)) continue; // near the terminator the map decides
            const double lit = hit.cosine > 0 ? visibility(hit.x, 6 * texel) : 0;
            if (lit != 0 && lit != 1) continue; // the shadow's edge
            const double albedo = hit.object == 0 ? 0.5 : hit.object == 4 ? 0.75 : 0.25;
            ASSERT_NEAR(double(picture.at(x, y).r), lit * albedo * hit.cosine / kPi, 1e-5)
                << x << ' ' << y << " of object " << hit.object << " at " << hit.x.x << ' ' << hit.x.y << ' '
                << hit.x.z;
            ++seen[hit.object];
            shadowed += lit == 0 && hit.object == 0;
        }
    EXPECT_GT(seen[0], 5000);
    EXPECT_GT(shadowed, 300);
    EXPECT_GT(seen[2], 150); // the box's top
    EXPECT_GT(seen[4], 200);
}

TEST_F(GpuTest, NoLightBehindABoxAndAllOfItBesideIt) {
    const Point hidden{{0, 5, 0}, 2, 1.5f}, free{{20, 5, 0}, 2, 1.5f}, above{{0, 10, 0}, 2, 1.5f};
    Scene scene = sceneOf({hidden, free, above});
    scene.lights[0].to_light = {0, 1, 0};
    const Scene without = scene;
    scene.boxes = {{{0, 7.6f, 0}, {6, 1, 6}, 0.3f, glm::vec3(0)}}; // black
    Stage stage(device(), scene, 3);
    for (const auto& [method, quadrature] :
         {std::pair("sphere", "simpson"), std::pair("isv", "simpson"), std::pair("isv", "transmittance"),
          std::pair("isv", "analytic"), std::pair("isv", "taylor")}) {
        SCOPED_TRACE(testing::Message() << method << ' ' << quadrature);
        Scene shaded = scene, open = without;
        shaded.render.method = open.render.method = method;
        setQuadrature(shaded.render, quadrature);
        setQuadrature(open.render, quadrature);
        float largest = 0;
        for (const Point& point : {hidden, free, above}) {
            const Pose pose = lookAt(point.centre + glm::vec3(0, 0, 6), point.centre, 0.6f);
            const Picture with = stage.see(shaded, pose, 64, 48), plain_one = plain().see(open, pose, 64, 48);
            for (size_t i = 0; i < with.pixels.size(); ++i) {
                const glm::vec4 expected =
                    point.centre == hidden.centre ? glm::vec4(0, 0, 0, plain_one.pixels[i].a) : plain_one.pixels[i];
                for (int c = 0; c < 4; ++c)
                    ASSERT_NEAR(with.pixels[i][c], expected[c], 1e-6f) << point.centre.y << ": " << i;
                largest = std::max(largest, with.pixels[i].r);
            }
            EXPECT_LT(plain_one.at(32, 24).a, 0.8f);
        }
        EXPECT_GT(largest, 0.01f);
    }
}

} // namespace
} // namespace brume::test::light_test
