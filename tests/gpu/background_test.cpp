// What is behind the medium: by draw and by compute, few objects and many, and edges.
#include <algorithm>
#include <array>
#include <cmath>

#include "server/effects/object_shadow/opaque_shadow.h"
#include "server/effects/shadow_volume/shadow_volume.h"
#include "server/opaque/mesh_buffers.h"
#include "server/opaque/object_buffers.h"
#include "server/opaque/surfaces.h"
#include "shaders/shared/sky.h"
#include "tests/gpu/closed_form.h"
#include "tests/gpu/light_passes.h"
#include "tests/layer.h"
#include "tools/reference/medium_reference.h"
#include "tools/reference/obstacle_tree.h"

namespace brume::test::background_test {
namespace {

constexpr VkImageUsageFlags kTarget = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                      VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;

class BackgroundTest : public GpuTest {
protected:
    struct Seen {
        std::vector<float> radiance, depth; // RGBA; view depth
    };

    static Seen see(const Scene& scene, const Pose& pose, uint32_t width, uint32_t height, bool by_draw) {
        const std::vector<gpu::Particle> particles = particlesOf(scene);
        const ObjectBuffers objects(device(), scene);
        const MeshBuffers meshes(device(), scene.triangles);
        const gpu::Tick tick = tickOf(scene, particles);
        const gpu::Buffer uniforms(device(), 768 + 256, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, gpu::Memory::upload,
                                   "uniforms");
        uniforms.mapped<gpu::Tick>(1)[0] = tick;
        gpu::Eye& eye = uniforms.mapped<gpu::Eye>(1, 768)[0];
        eye = {};
        eye.position = pose.position;
        eye.near_depth = float(kNearDepth);
        eye.size = {width, height};
        eye.back = pose.orientation * glm::vec3(0, 0, 1);
        const glm::dvec3 first = pixelDirection(pose, width, height, 0, 0);
        const glm::dvec3 right = pixelDirection(pose, width, height, 1, 0) - first,
                         down = pixelDirection(pose, width, height, 0, 1) - first;
        eye.ray = first - 0.5 * (right + down);
        eye.ray_right = right;
        eye.ray_down = down;
        const gpu::Buffer medium(device(), std::max<size_t>(particles.size(), 1) * sizeof(gpu::Particle),
                                 VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::upload, "particles");
        std::copy(particles.begin(), particles.end(), medium.mapped<gpu::Particle>(particles.size()).begin());
        const RenderTarget target{{device(), {VK_FORMAT_R32G32B32A32_SFLOAT, {width, height}, kTarget}, "radiance"},
                                  {device(), {VK_FORMAT_R32_SFLOAT, {width, height}, kTarget}, "depth"}};
        const gpu::Sampler linear(device(), VK_FILTER_LINEAR), nearest(device(), VK_FILTER_NEAREST);
        ShadowVolume volume(device(), uint32_t(particles.size()));
        OpaqueShadow casters(device());
        Surfaces surfaces(device(), objects.counts(), !scene.triangles.empty(), by_draw);
        surfaces.prepare(std::array{EyeRequest{pose, width, height}}, objects.counts(), objects.all());

        gpu::Commands commands(device(), "background");
        const VkCommandBuffer cmd = commands.begin();
        gpu::toGeneral(cmd, target.radiance);
        gpu::toGeneral(cmd, target.view_depth);
        const gpu::Buffer none(device(), 256, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, gpu::Memory::device, "nothing");
        gpu::Resources all;
        all.give(gpu::uniformBuffer("TickBlock", uniforms, 0, sizeof(gpu::Tick)));
        all.give(gpu::uniformBuffer("EyeBlock", uniforms, 768, 256));
        all.give(gpu::storageBuffer("Particles", medium));
        all.give(gpu::storageBuffer("Objects", objects.objects()));
        all.give(gpu::storageBuffer("ObjectNodes", objects.nodes()));
        all.give(gpu::storageBuffer("Triangles", meshes.triangles));
        all.give(gpu::storageBuffer("MeshNodes", meshes.nodes));
        for (const char* lights : {"LocalLights", "LightBits", "LightDepths", "UnionBits", "UnionLights", "Axes"})
            all.give(gpu::storageBuffer(lights, none));
        casters.record(commands, all, tick, objects.all());
        volume.record(commands, all, tick);
        all.give(gpu::sampledImage("shadow_volume", volume.image(), linear));
        all.give(gpu::sampledImage("glow", volume.image(), linear)); // not read: the medium lights no surface
        all.give(gpu::sampledImage("opaque_shadow", casters.image(), nearest));
        target.giveTo(all, nearest);
        const RenderSettings settings;
        const TickInputs shared{.settings = &settings,
                                .tick = &tick,
                                .bodies = tick.opaque_count - tick.plane_count,
                                .particles = &medium,
                                .nearest = &nearest};
        const EyeInputs in{.shared = &shared, .target = &target, .size = {width, height}, .resources = all};
        surfaces.record(commands, in);
        commands.submit();
        waitFor(commands);
        return {readImage(device(), target.radiance, 4), readImage(device(), target.view_depth, 1)};
    }
};

// The draw and the compute pass have the same formulas; roundings may differ by where compilers put them.
TEST_F(BackgroundTest, DrawAndComputeAgree) {
    BRUME_WHOLE_LAYER_ONLY();
    for (const char* name : {"props", "tubes", "plume", "cloud", "atrium-mesh"}) {
        SCOPED_TRACE(name);
        const Scene scene = loadScene(std::string("server/scenes/") + name + ".toml");
        const Pose pose = lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y);
        const Seen drawn = see(scene, pose, 131, 77, true), computed = see(scene, pose, 131, 77, false);
        for (size_t i = 0; i < drawn.radiance.size(); ++i)
            ASSERT_NEAR(drawn.radiance[i], computed.radiance[i], 1e-4f * (1 + std::abs(computed.radiance[i]))) << i;
        for (size_t i = 0; i < drawn.depth.size(); ++i) ASSERT_NEAR(drawn.depth[i] / computed.depth[i], 1, 1e-5f) << i;
    }
}

// Surfaces fade by the air on the way to them to the sky that is there; the sky does not.
TEST_F(BackgroundTest, HazeFadesSurfacesToTheSky) {
    Scene clear = sceneOf({Point{{0, 0, 0}, 1, 0}});
    clear.planes = {{-1, glm::vec3(0.5f, 0.3f, 0.2f)}};
    clear.sky.horizon = glm::vec3(0.2f, 0.3f, 0.4f), clear.sky.zenith = glm::vec3(0.1f, 0.2f, 0.5f);
    Scene hazy = clear;
    hazy.sky.haze = 0.1f;
    const Pose pose = lookAt({0, 1, 0}, {0, 0.5f, -20}, 0.8f);
    const uint32_t width = 48, height = 27;
    for (const bool by_draw : {true, false}) {
        const Seen without = see(clear, pose, width, height, by_draw), with = see(hazy, pose, width, height, by_draw);
        int near = 0, far = 0;
        for (uint32_t i = 0; i < width * height; ++i) {
            const glm::dvec3 dir = pixelDirection(pose, width, height, i % width, i / width);
            if (std::abs(dir.y) < 0.03) continue; // the edge: a mean of surface and sky
            const double distance = double(without.depth[i]) * glm::length(dir);
            const double air = dir.y < 0 ? std::exp(-0.1 * distance) : 1;
            near += dir.y < 0 && air > 0.5, far += dir.y < 0 && air < 0.1;
            for (int c = 0; c < 3; ++c) {
                const double part = physics::skyZenithPart(dir.y / glm::length(dir));
                const double sky = glm::mix(double(clear.sky.horizon[c]), double(clear.sky.zenith[c]), part);
                ASSERT_NEAR(double(with.radiance[4 * i + uint32_t(c)]),
                            sky + (double(without.radiance[4 * i + uint32_t(c)]) - sky) * air, 1e-4)
                    << i;
            }
        }
        EXPECT_GT(near, 100);
        EXPECT_GT(far, 20);
    }
}

// Every pixel of a ground with structure is as the reference has it, at all distances; other planes stay plain.
TEST_F(BackgroundTest, GroundWithStructure) {
    Scene scene = sceneOf({Point{{0, 0, 0}, 1, 0}});
    scene.planes = {{.height = -1, .albedo = {0.5f, 0.3f, 0.9f}, .structure = 0.8f, .structure_size = 3},
                    {.height = -4, .albedo = glm::vec3(0.4f)}};
    const Pose pose = lookAt({7000, 1, -3000}, {7000, 0, -3008}, 0.8f);
    const uint32_t width = 96, height = 54;
    const reference::World world = reference::worldOf(scene, particlesOf(scene));
    const reference::Camera camera = reference::perspective(pose, int(width), int(height), kNearDepth);
    reference::World plain = world;
    for (reference::Obstacle& plane : plain.obstacles) plane.structure = 0;
    for (const bool by_draw : {true, false}) {
        SCOPED_TRACE(by_draw ? "draw" : "compute");
        const Seen seen = see(scene, pose, width, height, by_draw);
        int varied = 0;
        for (uint32_t i = 0; i < width * height; ++i) {
            const uint32_t x = i % width, y = i / width;
            const reference::Ray ray = reference::rayThrough(camera, x + 0.5, y + 0.5);
            if (ray.direction.y > -1e-2) continue;
            const glm::dvec3 exact = reference::along(world, ray).total(), flat = reference::along(plain, ray).total();
            // Float has steps of 0.5 mm there, and the shortest waves are 66 mm long: 1 % of their amplitudes.
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(double(seen.radiance[4 * i + uint32_t(c)]) / exact[c], 1, 4e-3) << i;
            varied += std::abs(exact.x / flat.x - 1) > 0.05;
        }
        EXPECT_GT(varied, 500);
    }
    scene.planes[0].height = -5; // below the other one, which has no structure
    const Seen seen = see(scene, pose, width, height, true);
    const uint32_t last = 4 * (width * height - 1);
    EXPECT_NEAR(seen.radiance[last], seen.radiance[last - 4 * width / 2], 1e-6f);
    EXPECT_GT(seen.radiance[last], 0);
}

// More objects than a bin has first ones, and a wall that fills bins in front of others.
TEST_F(BackgroundTest, ManyObjects) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = sceneOf({Point{{0, 0, 0}, 1, 0}});
    Random random(7);
    scene.planes = {{-3, glm::vec3(0.5f)}};
    scene.boxes = {{{-3, 0, 4}, {5, 6, 0.5f}, 0.3f, glm::vec3(0.5f)}};
    for (int i = 0; i < 600; ++i) {
        scene.boxes.push_back(
            {random.inCube(6), glm::vec3(0.2f) + random.inCube(0.1f), random.uniform(0, 3), glm::vec3(0.5f)});
        scene.spheres.push_back({random.inCube(6), random.uniform(0.05f, 0.4f), glm::vec3(0.5f)});
    }
    const Pose pose = lookAt({1, 3, 15}, {0, 0, 0}, 0.8f);
    const uint32_t width = 160, height = 90;
    const auto depthAlong = [&](glm::dvec3 dir) {
        const glm::dvec3 eye(pose.position);
        double depth = dir.y < 0 ? (-3 - eye.y) / dir.y : 1e30;
        for (const Sphere& sphere : scene.spheres) {
            const glm::dvec3 off = glm::dvec3(sphere.centre) - eye;
            const double a = glm::dot(dir, dir), b = glm::dot(off, dir),
                         c = glm::dot(off, off) - double(sphere.radius) * double(sphere.radius);
            if (b * b > a * c) depth = std::min(depth, (b - std::sqrt(b * b - a * c)) / a);
        }
        for (const Box& box : scene.boxes) {
            const double c = std::cos(double(box.yaw)), s = std::sin(double(box.yaw));
            const auto toBox = [&](glm::dvec3 v) { return glm::dvec3(c * v.x - s * v.z, v.y, s * v.x + c * v.z); };
            const glm::dvec3 o = toBox(eye - glm::dvec3(box.centre)), d = toBox(dir), half = 0.5 * glm::dvec3(box.size);
            const glm::dvec3 one = (-half - o) / d, two = (half - o) / d, in = glm::min(one, two),
                             out = glm::max(one, two);
            const double enter = std::max({in.x, in.y, in.z}), leave = std::min({out.x, out.y, out.z});
            if (enter < leave) depth = std::min(depth, enter);
        }
        return depth;
    };
    for (const bool by_draw : {true, false}) {
        SCOPED_TRACE(by_draw ? "draw" : "compute");
        const Seen seen = see(scene, pose, width, height, by_draw);
        int near = 0, edges = 0;
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                const glm::dvec3 dir = pixelDirection(pose, width, height, x, y);
                const glm::dvec3 right = pixelDirection(pose, width, height, x + 1, y) - dir,
                                 down = pixelDirection(pose, width, height, x, y + 1) - dir;
                const double exact = depthAlong(dir), got = double(seen.depth[y * width + x]);
                double change = 0;
                for (const glm::dvec3 step : {right, down, -right, -down})
                    change = std::max(change, std::abs(depthAlong(dir + 1e-3 * step) / exact - 1));
                if (change > 1e-2) {
                    ++edges; // within a thousandth of a pixel
                    continue;
                }
                ASSERT_NEAR(got / exact, 1, 1e-4) << x << ' ' << y;
                near += exact < 30 && exact != (-3 - 3) / dir.y;
            }
        EXPECT_GT(near, 700);
        EXPECT_LT(edges, 40);
    }
}

// Triangles at random, of which each pixel sees the nearest.
TEST_F(BackgroundTest, NearestTriangles) {
    Scene scene = sceneOf({Point{{0, 0, 0}, 1, 0}});
    Random random(11);
    for (int i = 0; i < 1500; ++i) {
        const glm::vec3 at = random.inCube(5);
        scene.triangles.push_back({{at, at + random.inCube(0.6f), at + random.inCube(0.6f)}, glm::vec3(0.5f)});
    }
    const Pose pose = lookAt({1, 3, 15}, {0, 0, 0}, 0.8f);
    const uint32_t width = 160, height = 90;
    const std::vector<reference::Obstacle> obstacles = reference::obstaclesOf(scene.triangles);
    const reference::ObstacleTree tree(obstacles);
    const auto depthAlong = [&](glm::dvec3 dir) { // of unit view depth
        const double t = tree.nearest({glm::dvec3(pose.position), glm::normalize(dir)}).t / glm::length(dir);
        return std::min(t, 1e30);
    };
    for (const bool by_draw : {true, false}) {
        SCOPED_TRACE(by_draw ? "draw" : "compute");
        const Seen seen = see(scene, pose, width, height, by_draw);
        int hits = 0, edges = 0;
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                const glm::dvec3 dir = pixelDirection(pose, width, height, x, y);
                const glm::dvec3 right = pixelDirection(pose, width, height, x + 1, y) - dir,
                                 down = pixelDirection(pose, width, height, x, y + 1) - dir;
                const double exact = depthAlong(dir), got = double(seen.depth[y * width + x]);
                if (std::abs(got / exact - 1) < 1e-4) {
                    hits += exact < 1e30;
                    continue;
                }
                ++edges; // within a thousandth of a pixel one of the rays around sees the same
                const bool near_edge =
                    std::ranges::any_of(std::array{right, down, -right, -down}, [&](glm::dvec3 step) {
                        return std::abs(depthAlong(dir + 1e-3 * step) / exact - 1) > 1e-4;
                    });
                ASSERT_TRUE(near_edge) << x << ' ' << y << ' ' << got << ' ' << exact;
            }
        EXPECT_GT(hits, 2000);
        EXPECT_LT(edges, 20);
    }
}

// No ray leaves a closed mesh between its triangles.
TEST_F(BackgroundTest, ClosedMeshesAreTight) {
    Scene scene = sceneOf({Point{{0, 0, 0}, 1, 0}});
    const auto at = [](int i, int k) {
        const float polar = float(kPi) * float(i) / 60, around = 2 * float(kPi) * float(k % 90) / 90;
        if (i == 0 || i == 60) return glm::vec3(0, i == 0 ? 4 : -4, 0);
        return 4.0f *
               glm::vec3(std::sin(polar) * std::cos(around), std::cos(polar), std::sin(polar) * std::sin(around));
    };
    for (int i = 0; i < 60; ++i)
        for (int k = 0; k < 90; ++k) {
            scene.triangles.push_back({{at(i, k), at(i + 1, k), at(i + 1, k + 1)}, glm::vec3(0.5f)});
            scene.triangles.push_back({{at(i, k), at(i + 1, k + 1), at(i, k + 1)}, glm::vec3(0.5f)});
        }
    for (const bool by_draw : {true, false})
        for (const glm::vec3 target : {glm::vec3(1, 0.2f, 0.1f), glm::vec3(0, 1, 0.01f), glm::vec3(0, 0, -1)}) {
            const Seen seen = see(scene, lookAt({0, 0, 0}, target, 1.2f), 320, 180, by_draw);
            for (size_t i = 0; i < seen.depth.size(); ++i) ASSERT_LT(seen.depth[i], 4.1f) << i;
        }
}

// Across a straight edge between sky and a lit wall: a pixel's value is the part of its four samples that hit the wall.
TEST_F(BackgroundTest, EdgesAreFourSamples) {
    Scene scene = sceneOf({Point{{0, 0, 0}, 1, 0}});
    scene.sky = {glm::vec3(1), glm::vec3(1), glm::vec3(0)};
    scene.lights[0].irradiance = glm::vec3(0);
    scene.boxes = {{{50, 0, -1}, {100, 200, 2}, 0, glm::vec3(0)}}; // black, all x > 0
    const Pose pose = lookAt({0, 0, 10}, {0.04f, 0, 0}, 0.5f);
    const uint32_t width = 64, height = 48;
    for (const bool by_draw : {true, false}) {
        const Seen seen = see(scene, pose, width, height, by_draw);
        int between = 0;
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x) {
                double lit = 0, unclear = 0;
                for (const glm::dvec2 offset : {glm::dvec2(-0.375, -0.125), glm::dvec2(0.125, -0.375),
                                                glm::dvec2(0.375, 0.125), glm::dvec2(-0.125, 0.375)}) {
                    const glm::dvec3 dir = pixelDirection(pose, width, height, x, y) +
                                           offset.x * (pixelDirection(pose, width, height, x + 1, y) -
                                                       pixelDirection(pose, width, height, x, y)) +
                                           offset.y * (pixelDirection(pose, width, height, x, y + 1) -
                                                       pixelDirection(pose, width, height, x, y));
                    const double at = dir.x / -dir.z * 10; // where the ray meets the wall's front
                    lit += at < 0 ? 0.25 : 0;
                    unclear += std::abs(at) < 1e-4;
                }
                if (unclear > 0) continue;
                ASSERT_NEAR(double(seen.radiance[size_t(4) * (y * width + x)]), lit, 1e-5) << x << ' ' << y;
                between += lit > 0 && lit < 1;
            }
        EXPECT_GT(between, 10);
    }
}

} // namespace
} // namespace brume::test::background_test
