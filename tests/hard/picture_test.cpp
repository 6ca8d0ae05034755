// Pictures of every size, and many eyes at once.
#include <cmath>

#include "server/net/picture_size.h"
#include "tests/hard/hard.h"

namespace brume::test::picture_test {
namespace {

Scene someParticles() {
    Scene scene = sceneOf(randomPoints(40, 6, 2, 0.6f), kInside);
    scene.render.shadow_size = 64;
    return scene;
}

// Naive: a grid of groups that is rounded down, a division by width - 1, chroma of half a pixel.
TEST_F(HardTest, OddSizes) {
    const std::pair<uint32_t, uint32_t> sizes[] = {{1, 1},   {1, 7},   {7, 1},   {2, 3},   {17, 9},
                                                   {33, 31}, {255, 3}, {3, 255}, {129, 65}};
    const double k = std::sqrt(50.0) / 0.3; // of the smallest
    for (const auto& [width, height] : sizes)
        for (const Way& way : waysAndSampled()) {
            Scene scene = someParticles();
            choose(scene, way);
            if (refused("1x1 and odd sizes: transmittance", way, scene)) continue;
            const Seen seen =
                transmittance(plain(), scene, way, lookAt({0.3f, 0.2f, 9}, {0, 0, 0}, 0.7f), width, height);
            judge("1x1 and odd sizes: transmittance", way, seen.error,
                  5 * allowed(9, k, 0.5)); // five lie on a ray at most
        }
}

// 8192x8192 would be 1 GiB of radiance, as much to read it back: more than a small machine has. What a side of 8192 can
// break, both long strips show; and a viewer who wishes for all of it gets what the server's limits allow.
TEST_F(HardTest, PicturesOf8192) {
    for (const auto& [width, height] : {std::pair(8192u, 64u), std::pair(64u, 8192u)}) {
        Scene scene = someParticles();
        Stage stage(device(), scene, 40);
        const Pose pose = lookAt({0.3f, 0.2f, 9}, {0, 0, 0}, width > height ? 0.01f : 2.0f);
        const double k = std::sqrt(50.0) / 0.3;
        for (const Way& way : ways()) {
            choose(scene, way);
            if (refused("8192x64 and 64x8192: transmittance", way, scene)) continue;
            const Seen seen = transmittance(stage, scene, way, pose, width, height, 16);
            judge("8192x64 and 64x8192: transmittance", way, seen.error, 5 * allowed(9, k, 0.5));
            EXPECT_GT(seen.covered, 100); // of every sixteenth pixel
        }
    }
    const net::NetOptions options;
    const net::PictureSize got = net::fitSize({8192, 8192}, options);
    EXPECT_EQ(got.width, got.height);
    EXPECT_LE(uint32_t(got.width) * got.height, options.max_pixels);
    const net::PictureSize strip = net::fitSize({8192, 64}, options);
    EXPECT_LE(strip.width, options.max_side);
}

// Naive: scratch that eyes share is read before it is written, and the second eye sees the first one's order.
TEST_F(HardTest, SixteenIdenticalViewers) {
    Scene scene = loadScene("server/scenes/props.toml");
    scene.render.method = "sphere";
    scene.render.shadow_size = 64;
    const EyeRequest eye{lookAt({4, 2, 9}, {0, 0, 0}, 1), 49, 27};
    const std::vector<EyeRequest> sixteen(16, eye);
    const uint32_t capacity = Simulation(scene).capacity();
    Renderer renderer(device(), scene, capacity);
    renderer.keepRadiance(true);
    Submission submission(device(), "eyes");
    for (const Way& way : waysAndSampled()) {
        choose(scene, way);
        const Simulation simulation(scene);
        const auto bytesOf = [](const PictureView& picture) {
            return std::vector<uint8_t>(picture.bytes, picture.bytes + picture.layout.bytes());
        };
        submitAndWait(renderer, submission, simulation, {&eye, 1});
        const std::vector<uint8_t> alone = bytesOf(submission.pictures()[0]);
        const Picture radiance{eye.width, eye.height, renderer.readRadiance()};
        submitAndWait(renderer, submission, simulation, sixteen);
        int different = differing(radiance, {eye.width, eye.height, renderer.readRadiance()});
        ASSERT_EQ(submission.pictures().size(), sixteen.size());
        for (const PictureView& picture : submission.pictures()) different += bytesOf(picture) != alone;
        judge("16 identical viewers: pictures and pixels that differ from one viewer's", way, different, 0);
    }
}

} // namespace
} // namespace brume::test::picture_test
