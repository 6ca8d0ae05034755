// Interval shading: proxies, intervals, both ways of drawing, the quadratures.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "shaders/shared/orientation.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/quadrature.h"

namespace brume::test::isv_test {
namespace {

constexpr uint32_t kWidth = 96, kHeight = 72;

Scene isvScene(const std::vector<Point>& points, float falloff = 1.6f) {
    Scene scene = sceneOf(points, falloff);
    scene.render.method = "isv";
    scene.render.shadow_size = 32; // where radiance does not matter
    return scene;
}

// Float: places err by about 1e-6 m, ten times that where a ray grazes a face, and extinctions reach 4/m here.
constexpr double kFloat = 5e-5;

class IsvTest : public GpuTest {
protected:
    struct Seen {
        double excess = 0; // largest difference of transmittance beyond what rounding to subpixels explains
        double lowest = 1; // transmittance
        int covered = 0;   // pixels
    };
    // The transmittance of one tetrahedron at every pixel against its closed form. `number`: of the particle, which is
    // turned by chance; nothing: it is as all are.
    Seen compare(const Point& point, float falloff, const Pose& pose, std::optional<uint32_t> number = {}) {
        std::vector<Point> points(number.value_or(0), Point{{0, 0, 0}, 1, 0}); // not seen
        points.push_back(point);
        Scene scene = isvScene(points, falloff);
        if (number) scene.render.isv.orientation = "random";
        const reference::Blob blob = blobsOf(scene).back();
        const glm::dvec4 turn = number ? glm::dvec4(gpu::orientationOf(*number)) : glm::dvec4(0, 0, 0, 1);
        const glm::dquat back = glm::conjugate(glm::dquat(turn.w, turn.x, turn.y, turn.z));
        const Picture picture = plain().see(scene, pose, kWidth, kHeight);
        const glm::dvec3 corner = pixelDirection(pose, kWidth, kHeight, 0, 0);
        const glm::dvec3 right = pixelDirection(pose, kWidth, kHeight, 1, 0) - corner,
                         down = pixelDirection(pose, kWidth, kHeight, 0, 1) - corner;
        // The transmittance of a pixel that looks up its interval `off` (pixels) away, where the proxy's vertices are
        // off.
        const auto exact = [&](uint32_t x, uint32_t y, glm::dvec2 off) {
            const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
            const glm::dvec3 here = pixelDirection(pose, kWidth, kHeight, x, y),
                             there = here + off.x * right + off.y * down;
            const double scale = glm::length(here) / glm::length(there); // of distances, where view depths are the same
            const Interval inside = test::insideTetrahedron(
                blob, {blob.centre + back * (ray.eye - blob.centre), back * glm::normalize(there), ray.begin / scale});
            return std::exp(-depthOn(blob, ray, {inside.begin * scale, inside.end * scale}));
        };
        const double most = subpixel(device()); // vertices are rounded where they are drawn
        Seen seen;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const double here = exact(x, y, {0, 0});
                const glm::vec4 got = picture.at(x, y);
                for (int c = 0; c < 4; ++c) EXPECT_TRUE(std::isfinite(got[c])) << x << ' ' << y;
                const double error = std::abs(double(got.a) - here);
                double explained = 0;
                for (const glm::dvec2 off :
                     {glm::dvec2(1, 0), glm::dvec2(1, 1), glm::dvec2(0, 1), glm::dvec2(-1, 1), glm::dvec2(-1, 0),
                      glm::dvec2(-1, -1), glm::dvec2(0, -1), glm::dvec2(1, -1)})
                    if (error > kFloat) explained = std::max(explained, std::abs(exact(x, y, most * off) - here));
                const double excess = error - explained;
                if (!(excess <= seen.excess)) seen.excess = excess; // NaN too
                seen.lowest = std::min(seen.lowest, here);
                seen.covered += here < 1 - 1e-3;
            }
        return seen;
    }
};

TEST_F(IsvTest, TransmittanceFromOutside) {
    Random random(3);
    int whole = 0, partly = 0; // how much of the picture's middle or edge is covered
    for (int i = 0; i < 40; ++i) {
        const Point point{random.inCube(3), random.uniform(0.5f, 3), random.uniform(0.3f, 4)};
        const glm::vec3 away = random.direction() * point.scale;
        const glm::vec3 from = point.centre + away * random.uniform(1.3f, 4);
        const glm::vec3 to =
            point.centre + random.inCube(i % 2 ? 0.2f : 2 * point.scale); // also past the picture's edge
        const Pose pose = lookAt(from, to, random.uniform(0.5f, 1.2f));
        if (verticesBehind(point, pose) > 0) continue;
        const Seen seen = compare(point, i % 3 ? 8 : 1.6f, pose);
        EXPECT_LT(seen.excess, kFloat) << i;
        (i % 2 ? whole : partly) += seen.covered > 100;
    }
    EXPECT_GT(whole, 15);
    EXPECT_GT(partly, 8);
}

// As above, and with the eye at edges, faces and vertices, and so near that the near plane cuts: tetrahedra that are
// turned by chance, each by its number.
TEST_F(IsvTest, TransmittanceOfTurnedTetrahedra) {
    Random random(4);
    int covered = 0, cut = 0;
    for (uint32_t i = 0; i < 60; ++i) {
        const Point point{random.inCube(3), random.uniform(0.5f, 3), random.uniform(0.3f, 4)};
        const glm::vec4 turn = gpu::orientationOf(i);
        const auto vertex = [&](int v) { return point.centre + point.scale * gpu::turned(turn, kVertices[v]); };
        const glm::vec3 away = random.direction() * point.scale, along = vertex(1) - vertex(0);
        const glm::vec3 face = (vertex(0) + vertex(1) + vertex(2)) / 3.0f;
        const Pose poses[] = {lookAt(point.centre + away * random.uniform(1.3f, 4), point.centre, 0.8f),
                              lookAt(vertex(0) - 2.0f * along, point.centre, 0.6f),
                              lookAt(face + 3.0f * along, face, 0.6f), // in the plane of a face
                              lookAt(vertex(2), point.centre, 1), lookAt(point.centre + 0.2f * away, face, 1)};
        const Pose& pose = poses[i % std::size(poses)];
        const Seen seen = compare(point, i % 3 ? 8 : 1.6f, pose, i);
        EXPECT_LT(seen.excess, kFloat) << i;
        covered += seen.covered > 100;
        cut += i % std::size(poses) == 4 && seen.covered > 100;
    }
    EXPECT_GT(covered, 40);
    EXPECT_GT(cut, 8);
}

// --- both paths ---

// The vertices are the same, but a driver may place them in the picture an ulp apart: Mesa's vertex path contracts what
// its mesh path rounds.
TEST_F(GpuTest, MeshAndVertexShadersDrawTheSame) {
    // Mesa's CPU driver has mesh shaders; on a device without them both pictures are drawn the same way.
    EXPECT_TRUE(device().hasMeshShaders() || device().name().find("llvmpipe") == std::string::npos);
    Scene scene = loadScene("server/scenes/cloud.toml");
    scene.render.method = "isv";
    scene.render.shadow_size = 64;
    const std::vector<gpu::Particle> particles = particlesOf(scene);
    const auto vertex = [&](size_t particle, int number) {
        return particles[particle].centre + particles[particle].scale * kVertices[number];
    };
    const Pose poses[] = {
        lookAt({0, 2, 26}, {0, 0, 0}, 0.8f),
        lookAt({1, 0, 2}, {0, 0, 0}, 1.2f),
        lookAt({-40, 300, 900}, {0, 0, 0}, 0.05f),                                    // less than a pixel each
        lookAt(vertex(7, 0) - 2.0f * (vertex(7, 1) - vertex(7, 0)), vertex(7, 1), 1), // along an edge
        lookAt(vertex(11, 2), particles[11].centre, 0.9f),                            // at a vertex
        lookAt({0, 0, 5}, {0, 0, 20}, 1.5f),                                          // away from most
    };
    std::vector<std::pair<Pose, const char*>> both;
    for (const Pose& pose : poses) both.insert(both.end(), {{pose, "aligned"}, {pose, "random"}});
    for (const auto& [pose, orientation] : both) {
        scene.render.isv.orientation = orientation;
        const Picture mesh = plain().see(scene, pose, kWidth, kHeight),
                      vertices = plainWithoutMesh().see(scene, pose, kWidth, kHeight);
        float lowest = 1, brightest = 0;
        for (const glm::vec4& pixel : mesh.pixels)
            lowest = std::min(lowest, pixel.a), brightest = std::max(brightest, pixel.r);
        for (size_t i = 0; i < mesh.pixels.size(); ++i) {
            ASSERT_NEAR(mesh.pixels[i].a, vertices.pixels[i].a, 2e-6f) << pose.position.z << ": " << i;
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(mesh.pixels[i][c], vertices.pixels[i][c], 5e-6f * brightest)
                    << pose.position.z << ": " << i;
        }
        EXPECT_LT(lowest, 0.99f) << pose.position.z;
    }
}

// --- quadratures ---

struct Rule {
    const char* name;
    uint32_t steps;
    double
        bounds[2]; // on the error against the rule's limit, relative to the largest value, for optical depth 0.5 and 3
};

// A picture is the rule's sum; and the sum approaches its limit: for Simpson's rule the integral with light depth
// linear between entry and exit, for the analytical form the integral with light depth linear in the view depth, else
// the integral itself.
TEST_F(GpuTest, QuadraturesAreTheirDefinitionsAndConverge) {
    const Rule rules[] = {{"simpson", 1, {0.9, 0.9}},          {"simpson", 2, {0.13, 0.14}},
                          {"simpson", 10, {1e-5, 2e-5}},       {"transmittance", 1, {0.1, 0.2}},
                          {"transmittance", 2, {0.011, 0.07}}, {"transmittance", 3, {0.004, 0.03}},
                          {"analytic", 1, {1e-9, 1e-9}}};
    const double depths[] = {0.5, 3};
    const double rounding =
        std::max(0.0, subpixel(device()) - 1.0 / 256); // of vertices, pixels, beyond what 1e-4 below allows for
    const Pose pose = lookAt({0.5f, 1, 7}, {0, 0, 0}, 0.5f);
    for (int d = 0; d < 2; ++d)
        for (const glm::vec3 to_light : {glm::vec3(0.3f, 0.8f, 0.5f), glm::vec3(0, 0, -1), glm::vec3(-1, 0.2f, 0.1f)})
            for (const Rule& rule : rules) {
                SCOPED_TRACE(testing::Message()
                             << rule.name << ' ' << rule.steps << ", depth " << depths[d] << ", light " << to_light.z);
                const std::string name = rule.name;
                Scene scene = isvScene({Point{{0, 0, 0}, 2, float(depths[d] / (2 * 1.6 * std::sqrt(kPi / 50)))}});
                scene.lights[0].to_light = glm::normalize(to_light);
                scene.render.shadow_size = 256;
                scene.render.shadow_slices = 128;
                setQuadrature(scene.render, rule.name);
                scene.render.isv.steps = rule.steps;
                const auto blobs = blobsOf(scene);
                const reference::LightField field(blobs, glm::normalize(glm::dvec3(scene.lights[0].to_light)));
                const Picture picture = plain().see(scene, pose, kWidth, kHeight);
                // The rule's sum on a pixel's ray, and what it approaches; none where the ray is less than 5 cm inside.
                struct Sums {
                    double sum, limit;
                };
                const auto sumsAt = [&](uint32_t x, uint32_t y) -> std::optional<Sums> {
                    const Ray ray = rayThrough(pose, kWidth, kHeight, x, y);
                    const Interval inside = insideTetrahedron(blobs[0], ray);
                    if (inside.length() < 0.05) return {}; // silhouettes are another test's
                    const auto light = [&](double t) { return field.depth(ray.at(t)); };
                    const double in = light(inside.begin), out = light(inside.end),
                                 whole = depthOn(blobs[0], ray, inside);
                    const auto along_ray = [&](double t) {
                        return glm::mix(in, out, (t - inside.begin) / inside.length());
                    };
                    const auto along_depth = [&](double t) {
                        return glm::mix(in, out, depthOn(blobs[0], ray, {inside.begin, t}) / whole);
                    };
                    if (name == "simpson")
                        return Sums{simpson(blobs[0], ray, inside, int(rule.steps), along_ray),
                                    scatteredOn(blobs[0], ray, inside, along_ray)};
                    if (name == "transmittance")
                        return Sums{transmittanceSpace(blobs[0], ray, inside, int(rule.steps), light),
                                    scatteredOn(blobs[0], ray, inside, light)};
                    const double x1 = whole + out - in;
                    return Sums{whole * std::exp(-in) * (std::abs(x1) < 1e-6 ? 1 : -std::expm1(-x1) / x1),
                                scatteredOn(blobs[0], ray, inside, along_depth)};
                };
                double largest = 0, worst = 0, worst_of_rule = 0, slope = 0; // per pixel
                for (uint32_t y = 0; y < kHeight; y += 3)
                    for (uint32_t x = 0; x < kWidth; x += 3) {
                        const std::optional<Sums> here = sumsAt(x, y);
                        if (!here) continue;
                        worst = std::max(worst, std::abs(double(picture.at(x, y).r) * 4 * kPi - here->sum));
                        worst_of_rule = std::max(worst_of_rule, std::abs(here->sum - here->limit));
                        largest = std::max(largest, here->limit);
                        if (rounding == 0) continue;
                        for (const glm::uvec2 there : {glm::uvec2(x + 1, y), glm::uvec2(x, y + 1)})
                            if (const std::optional<Sums> next = sumsAt(there.x, there.y))
                                slope = std::max(slope, std::abs(next->sum - here->sum));
                    }
                // The shadow volume interpolates between texels of 1/33 and planes of 1/16 of 1/k: h^2/8 of second
                // derivatives of at most 2 k^2 tau in two directions and 0.49 k^2 tau along the light.
                const double interpolation = depths[d] * (4 / (33.0 * 33) + 0.49 / (16.0 * 16)) / 8;
                EXPECT_LT(worst, largest * (interpolation + 1e-4) + slope * rounding);
                EXPECT_LT(worst_of_rule, largest * rule.bounds[d]);
            }
}

// Particles without volume in view: nothing is added and nothing breaks.
TEST_F(GpuTest, NothingComesFromNothing) {
    const Pose pose = lookAt({0, 0, 3}, {0, 0, 0}, 0.6f);
    for (const char* quadrature : {"simpson", "transmittance", "analytic", "taylor"})
        for (const Point& point : {Point{{0, 0, 0}, 1, 0}, Point{{0, 0, 0}, 1e-3f, 1e-3f}, Point{{0, 0, 50}, 1, 2}}) {
            Scene scene = isvScene({point});
            setQuadrature(scene.render, quadrature);
            for (const glm::vec4& pixel : plain().see(scene, pose, kWidth, kHeight).pixels) {
                ASSERT_EQ(pixel.r, 0);
                ASSERT_EQ(pixel.a, 1);
            }
        }
}

} // namespace
} // namespace brume::test::isv_test
