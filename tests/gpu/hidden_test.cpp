// Particles behind objects cost no work, and pictures are the same bits as if they did.
#include <algorithm>
#include <cmath>
#include <map>

#include "server/inputs/eye_block.h"
#include "server/methods/proxies/depth_order.h"
#include "server/methods/proxies/furthest_depths.h"
#include "shaders/shared/support.h"
#include "tests/gpu/judged.h"
#include "tests/gpu/light_passes.h"
#include "tests/gpu/quadrature.h"

namespace brume::test::hidden_test {
namespace {

constexpr uint32_t kWide = 101, kHigh = 67; // no multiple of a tile's
constexpr float kSky = 1e30f;               // view depth where nothing is hit

// A picture of view depths: `depth` in the pixels x0 <= x < x1, y0 <= y < y1, where it is less than what is there.
struct Depths {
    uint32_t width = kWide, height = kHigh;
    std::vector<float> pixels = std::vector<float>(size_t(width) * height, kSky);
    Depths& wall(uint32_t x0, uint32_t y0, uint32_t x1, uint32_t y1, float depth) {
        for (uint32_t y = y0; y < std::min(y1, height); ++y)
            for (uint32_t x = x0; x < std::min(x1, width); ++x)
                pixels[y * width + x] = std::min(pixels[y * width + x], depth);
        return *this;
    }
};

class HiddenTest : public JudgedTest {
protected:
    // The particles that are drawn, in order.
    static std::vector<uint32_t> drawn(const Scene& scene, const Pose& pose, const Depths& depths) {
        const std::vector<gpu::Particle> particles = particlesOf(scene);
        const gpu::Device& on = device();
        const gpu::Sampler nearest(on, VK_FILTER_NEAREST);
        const VkExtent2D size{depths.width, depths.height}, larger{size.width + 9, size.height + 5}; // as targets are
        RenderTarget target;
        target.view_depth =
            gpu::Image(on, {VK_FORMAT_R32_SFLOAT, larger, VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT},
                       "view depth");
        const gpu::Buffer upload(on, depths.pixels.size() * sizeof(float), VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                                 gpu::Memory::upload, "depths");
        std::ranges::copy(depths.pixels, upload.mapped<float>(depths.pixels.size()).begin());
        const gpu::Buffer block(on, 256, VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, gpu::Memory::upload, "eye");
        block.mapped<gpu::Eye>(1)[0] = eyeBlock({pose, size.width, size.height}, scene.render);
        const auto readback = [&](size_t words) {
            return gpu::Buffer(on, words * sizeof(uint32_t), VK_BUFFER_USAGE_TRANSFER_DST_BIT, gpu::Memory::readback,
                               "read back");
        };
        constexpr size_t kWords = sizeof(gpu::DrawArguments) / sizeof(uint32_t);
        const gpu::Buffer order = readback(particles.size()), arguments = readback(kWords);
        FurthestDepths furthest(on);
        DepthOrder depth_order(on, uint32_t(particles.size()));
        recordAndWait(on, tickOf(scene, particles), "Particles", particles,
                      [&](gpu::Commands& commands, gpu::Resources& shared) {
                          const VkCommandBuffer cmd = commands.handle();
                          gpu::toGeneral(cmd, target.view_depth);
                          gpu::everythingBefore(cmd);
                          VkBufferImageCopy copy{};
                          copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
                          copy.imageExtent = {size.width, size.height, 1};
                          vkCmdCopyBufferToImage(cmd, upload.handle(), target.view_depth.handle(),
                                                 VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
                          const TickInputs tick{.nearest = &nearest};
                          const MediumView medium{.resources = shared, .count = uint32_t(particles.size())};
                          const gpu::Resource eye = gpu::uniformBuffer("EyeBlock", block, 0, 256);
                          EyeInputs in{.shared = &tick, .medium = &medium, .target = &target, .size = size};
                          in.resources = gpu::Resources(&medium.resources);
                          in.resources.give(eye);
                          in.resources.give(eye.as("OtherBlock"));
                          in.resources.give(gpu::sampledImage("view_depth", target.view_depth, nearest));
                          furthest.prepare({&in, 1});
                          depth_order.record(commands, in, DepthOrder::Support::sphere, 8, 1, &furthest);
                          gpu::everythingBefore(cmd);
                          const VkBufferCopy values{0, 0, order.size()}, counts{0, 0, arguments.size()};
                          vkCmdCopyBuffer(cmd, depth_order.order().handle(), order.handle(), 1, &values);
                          vkCmdCopyBuffer(cmd, depth_order.arguments().handle(), arguments.handle(), 1, &counts);
                          gpu::transferToHost(cmd);
                      });
        order.invalidate();
        arguments.invalidate();
        const uint32_t count = arguments.mapped<gpu::DrawArguments>(1)[0].instance_count;
        const auto all = order.mapped<uint32_t>(particles.size());
        return {all.begin(), all.begin() + std::ptrdiff_t(count)};
    }

    // The particles with a part before the surface of some pixel's ray, in double; sorted.
    static std::vector<uint32_t> seen(const Scene& scene, const Pose& pose, const Depths& depths) {
        const std::vector<gpu::Particle> particles = particlesOf(scene);
        const gpu::Tick tick = tickOf(scene, particles);
        std::vector<uint32_t> result;
        for (uint32_t i = 0; i < particles.size(); ++i) {
            const gpu::Particle& p = particles[i];
            const double r = double(physics::supportRadius(p.sigma_t, p.scale * tick.falloff, tick.cut));
            const glm::dvec3 c = glm::dvec3(p.centre) - glm::dvec3(pose.position);
            bool some = false;
            for (uint32_t y = 0; y < depths.height && !some; ++y)
                for (uint32_t x = 0; x < depths.width && !some; ++x) {
                    const glm::dvec3 dir = pixelDirection(pose, depths.width, depths.height, x, y);
                    const double along = glm::dot(c, dir) / glm::dot(dir, dir), // view depths
                        half2 = (r * r - glm::dot(c, c)) / glm::dot(dir, dir) + along * along;
                    if (half2 <= 0) continue;
                    const double near = std::max(along - std::sqrt(half2), kNear), far = along + std::sqrt(half2);
                    some = near < far && near < double(depths.pixels[y * depths.width + x]);
                }
            if (some) result.push_back(i);
        }
        return result;
    }

    static void expectAllSeenDrawn(const Scene& scene, const Pose& pose, const Depths& depths) {
        std::vector<uint32_t> got = drawn(scene, pose, depths);
        std::ranges::sort(got);
        const std::vector<uint32_t> needed = seen(scene, pose, depths);
        EXPECT_TRUE(std::ranges::includes(got, needed)) << got.size() << " drawn, " << needed.size() << " are seen";
    }

    // A cloud of several clumps, and a wall that hides those of one side from kFront.
    static Scene walled(const char* method) {
        std::vector<Point> points = randomPoints(200, 9, 2.5f, 0.1f, 5);
        points.push_back({{0, 1, 6.2f}, 3, 0.1f});    // straddles the wall
        points.push_back({{-1, 0, 16}, 2, 0.05f});    // the eye is in it
        points.push_back({{0, -1, 15.9f}, 1, 0.05f}); // the near plane cuts it
        Scene scene = sceneOf(points, 1.6f);
        scene.render.method = method;
        scene.render.shadow_size = 64;
        scene.boxes = {{{-5.2f, 0, 6}, {10, 30, 0.3f}, 0, glm::vec3(0.5f)}};
        return scene;
    }
    static inline const Pose kFront = lookAt({0, 0, 16}, {0, 0, 0}, 0.9f);
};

// Walls of any size anywhere: what a pixel sees is drawn. Particles of all sizes, also around the eye.
TEST_F(HiddenTest, CullingDropsNothingThatIsSeen) {
    Random random(3);
    for (int round = 0; round < 12; ++round) {
        std::vector<Point> points(150);
        for (Point& p : points)
            p = {random.inCube(12), std::exp(random.uniform(-2, 1.6f)), 0.02f * std::exp(random.uniform(0, 3))};
        const Scene scene = sceneOf(points, 1.6f);
        Depths depths;
        for (int i = 0; i < 3 + round; ++i) {
            const auto side = [&](uint32_t most) { return uint32_t(random.uniform(0, float(most) + 0.99f)); };
            const uint32_t x = side(kWide), y = side(kHigh);
            depths.wall(x, y, x + side(kWide), y + side(kHigh), random.uniform(0.05f, 14));
        }
        if (round % 3 == 0) depths.wall(0, 0, kWide, kHigh, 9); // no sky
        const glm::vec3 eye = round % 2 == 0 ? glm::vec3(0, 1, 11) : random.inCube(5);
        expectAllSeenDrawn(scene, lookAt(eye, random.inCube(4), random.uniform(0.4f, 2)), depths);
    }
}

// A particle whose picture is as wide as a tile, in steps of a pixel across the edge of a wall that lies on a border of
// tiles, one pixel before, and in a tile's middle.
TEST_F(HiddenTest, TheEdgeOfAWallIsThatOfWhatItHides) {
    for (const uint32_t edge : {47u, 48u, 49u, 56u}) {
        Depths depths;
        depths.wall(0, 0, edge, kHigh, 10);
        const Pose pose = lookAt({0, 0, 0}, {0, 0, -1}, 0.8f);
        std::vector<Point> points;
        const double pixel = 2 * std::tan(0.4) / kHigh * 20;
        for (int x = 0; x < int(kWide); ++x)
            points.push_back({{float((x - 0.5 * kWide) * pixel), 0.3f, -20}, float(10 * pixel), 0.3f});
        const Scene scene = sceneOf(points, 1);
        expectAllSeenDrawn(scene, pose, depths);
        EXPECT_LT(drawn(scene, pose, depths).size(), kWide - edge + 34) << edge; // those that meet the wall's last tile
    }
}

// Behind a wall, before it, through it; around the eye; behind a wall at the near plane; beside it.
TEST_F(HiddenTest, OnlyWhatIsWhollyBehindIsLeftOut) {
    const Scene scene = sceneOf({{{0, 0, -20}, 4, 0.1f},
                                 {{0, 0, -5}, 2, 0.1f},
                                 {{0, 0, -10.5f}, 3, 0.1f},
                                 {{0.1f, 0, 0}, 2, 0.1f},
                                 {{8, 1, -18}, 4, 0.1f}},
                                1.6f);
    const Pose pose = lookAt({0, 0, 0}, {0, 0, -1}, 0.8f);
    using Drawn = std::vector<uint32_t>;
    EXPECT_EQ(drawn(scene, pose, Depths()), (Drawn{0, 4, 2, 1, 3}));
    EXPECT_EQ(drawn(scene, pose, Depths().wall(0, 0, kWide, kHigh, 10)), (Drawn{2, 1, 3}));
    EXPECT_EQ(drawn(scene, pose, Depths().wall(0, 0, kWide, kHigh, 1)), (Drawn{3}));
    EXPECT_EQ(drawn(scene, pose, Depths().wall(0, 0, kWide, kHigh, float(kNear))), (Drawn{3}));
    EXPECT_EQ(drawn(scene, pose, Depths().wall(0, 0, kWide / 2, kHigh, 10)), (Drawn{0, 4, 2, 1, 3}));
    // A gap of one pixel shows what is behind it.
    Depths gap;
    gap.wall(0, 0, kWide, 33, 10).wall(0, 34, kWide, kHigh, 10).wall(0, 0, 50, kHigh, 10).wall(51, 0, kWide, kHigh, 10);
    EXPECT_EQ(drawn(scene, pose, gap), (Drawn{0, 2, 1, 3}));
}

// The two eyes of a head share their order, and nothing is left out of it. At one place they see what one eye sees:
// with particles left out that is the same bits.
TEST_F(HiddenTest, PicturesAreThoseWithAllParticles) {
    for (const char* method : {"isv", "sphere"}) {
        Scene scene = walled(method);
        setQuadrature(scene.render, "simpson");
        for (const Pose& pose :
             {kFront, lookAt({1.5f, 2, 9}, {-4, 0, 0}, 1.3f), lookAt({-3, 0, 7}, {-3, 0, 0}, 0.9f)}) {
            const Simulation simulation(scene);
            Renderer renderer(device(), scene, simulation.capacity());
            renderer.keepRadiance(true);
            Submission submission(device(), "hidden");
            const EyeRequest one{pose, kWide, kHigh}, second{pose, kWide, kHigh, true};
            submitAndWait(renderer, submission, simulation, std::array{one, second});
            const std::vector<glm::vec4> all = renderer.readRadiance();
            submitAndWait(renderer, submission, simulation, std::array{one});
            EXPECT_TRUE(all == renderer.readRadiance()) << method;
        }
    }
}

// Eyes apart see past different edges of a wall: both are right.
TEST_F(HiddenTest, EachEyeOfAHeadSeesPastItsOwnEdge) {
    Scene scene = walled("sphere");
    Pose pose = kFront;
    pose.eye_separation = 0.8f;
    const Simulation simulation(scene);
    Renderer renderer(device(), scene, simulation.capacity());
    renderer.keepRadiance(true);
    Submission submission(device(), "head");
    const EyeRequest left{eyePose(pose, 0, 2), kWide, kHigh}, right{eyePose(pose, 1, 2), kWide, kHigh, true};
    submitAndWait(renderer, submission, simulation, std::array{left, right});
    const std::vector<glm::vec4> shared = renderer.readRadiance();
    scene.render.shared_order = false;
    renderer.submit(submission, simulation, std::array{left, right}, &scene.render);
    waitFor(submission.commands);
    const std::vector<glm::vec4> own = renderer.readRadiance();
    for (size_t i = 0; i < own.size(); ++i) ASSERT_NEAR(shared[i].a, own[i].a, 1e-5) << i; // the order of products
}

// Of rays only what is before a tile's surfaces is made. Particles that a wall hides could as well not exist: the
// transmittance is the same bits. The others reach as far in all directions, and no ray beside the wall meets what is
// hidden, however much particles are widened.
TEST_F(HiddenTest, RaysShowNothingOfWhatIsHidden) {
    std::vector<Point> points = randomPoints(56, 5, 2, 0.2f, 9);
    for (Point& p : points) p = {p.centre + glm::vec3(-5, 0, 0), 2, 0.2f};
    for (const float x : {-9.f, 9.f})
        for (const float y : {-6.f, 6.f})
            for (const float z : {-8.f, 8.f}) points.push_back({{x, y, z}, 2, 0.2f});
    const std::vector<Point> visible = points;
    for (int i = 0; i < 64; ++i) points.push_back({{7 + 0.02f * float(i), 0.02f * float(i), -6}, 2, 0.3f});
    const Pose poses[] = {lookAt({0, 0, 26}, {0, 0, 0}, 0.6f), lookAt({2, 1, 12}, {4, 0, 0}, 1.1f)};
    constexpr uint32_t kWider = 3 * kWide, kHigher = 3 * kHigh;
    for (const float sun : {0.3f, -0.9f}) // the wall's shadow falls on particles; it falls toward the eye
        for (const char* method : {"slabs", "grid"}) {
            Scene all = sceneOf(points, 1.6f), few = sceneOf(visible, 1.6f);
            for (Scene* scene : {&all, &few}) {
                scene->lights[0].to_light = glm::normalize(glm::vec3(0.1f, 0.4f, sun));
                scene->render.method = method;
                scene->render.slabs = 64;
                scene->render.cutoff = 1e-5f * float(scene->medium.count); // the same for each particle
                scene->boxes = {{{6, 0, 4}, {10, 14, 0.2f}, 0, glm::vec3(0.5f)}};
            }
            Stage stage(device(), all, uint32_t(points.size())), other(device(), few, uint32_t(visible.size()));
            for (const uint32_t rate : {1u, 3u, 8u})
                for (const Pose& pose : poses) {
                    all.render.rate = few.render.rate = rate;
                    const Picture with = stage.see(all, pose, kWider, kHigher),
                                  without = other.see(few, pose, kWider, kHigher);
                    size_t apart = 0;
                    for (size_t i = 0; i < with.pixels.size(); ++i) apart += with.pixels[i].a != without.pixels[i].a;
                    EXPECT_EQ(apart, 0u) << method << ", rate " << rate << ", from " << pose.position.z;
                }
        }
}

// A wall at any depth ends the medium there: rays read some slabs behind it, and those are made. Exact depths, by
// closed forms; 0.13 % was measured at most.
TEST_F(HiddenTest, WallsAtEveryDepthEndTheMediumThere) {
    Scene scene = sceneOf(randomPoints(60, 6, 9, 0.02f), 1.6f);
    scene.render.method = "slabs";
    scene.render.rate = 1;
    scene.render.slabs = 32;
    const std::vector<reference::Blob> blobs = blobsOf(scene);
    const Pose pose = lookAt({0, 0, 24}, {0, 0, 0}, 0.5f);
    scene.boxes = {{{0, 0, 0}, {400, 400, 100}, 0, glm::vec3(0)}};
    for (int step = 0; step < 24; ++step) {
        const double face = -3 + 0.27 * step;
        scene.boxes[0].centre.z = float(face - 50);
        const Picture picture = render(device(), scene, pose, kWide, kHigh);
        double squares = 0, all = 0;
        for (uint32_t y = 3; y < kHigh; y += 12)
            for (uint32_t x = 3; x < kWide; x += 12) {
                const Ray ray = rayThrough(pose, kWide, kHigh, x, y);
                double exact = 0;
                for (const reference::Blob& blob : blobs)
                    exact += depthOn(blob, ray, {ray.begin, (face - ray.eye.z) / ray.w.z});
                squares += std::pow(-std::log(double(picture.at(x, y).a)) - exact, 2);
                all += exact * exact;
            }
        EXPECT_LT(std::sqrt(squares / all), 2e-3) << "a wall at " << face;
    }
}

// The true picture, with a wall before most of the medium, whose shadow falls on it.
TEST_F(HiddenTest, AWallBeforeMostOfTheMediumErrsNoMore) {
    Scene scene = sceneOf(randomPoints(200, 9, 2.5f, 0.1f, 5), 1.6f);
    scene.render.shadow_size = 256;
    scene.render.slabs = 96;
    scene.boxes = {{{-2, 0, 4}, {9, 30, 0.3f}, 0.2f, glm::vec3(0.5f)}};
    judge(scene, {kFront, lookAt({9, 3, 9}, {0, 0, 0}, 0.9f)});
}

} // namespace
} // namespace brume::test::hidden_test
