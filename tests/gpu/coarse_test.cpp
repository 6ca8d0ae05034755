// Pictures of which fewer pixels are shaded or drawn than they have.
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/gpu/fixture.h"
#include "tests/layer.h"

namespace brume::test::coarse_test {
namespace {

class CoarseTest : public GpuTest {};

std::vector<uint8_t> bytesOf(const PictureView& picture) {
    return {picture.bytes, picture.bytes + picture.layout.bytes()};
}

// Pixels between shaded ones follow by interpolation. The bound is of rounding: two values that differ by less than
// half a level may become neighbouring bytes, no others.
TEST_F(CoarseTest, ShadingSomePixelsIsAsGoodAsShadingAll) {
    struct Case {
        const char* tone_map;
        float asymmetry; // of a lobe seen against the light; 0: none
        glm::vec3 camera;
    };
    for (const auto& [tone_map, asymmetry, camera] :
         {Case{"filmic", 0, {0, 2, 26}}, Case{"linear", 0.6f, {0, 2, 26}}, Case{"filmic", 0.85f, {0, -12, 16}}}) {
        SCOPED_TRACE(testing::Message() << tone_map << ' ' << asymmetry << ' ' << camera.z);
        Scene scene = loadScene("server/scenes/cloud.toml");
        scene.render.method = "slabs";
        scene.render.tone_map = tone_map;
        scene.medium.anisotropy = asymmetry > 0 ? 0.5f : 0;
        scene.medium.asymmetry = asymmetry;
        const EyeRequest eye{lookAt(camera, {0, 0, 0}, 0.8f), 641, 359};
        for (const uint32_t rate : {16u, 8u, 4u}) {
            scene.render.rate = rate;
            const auto planesOf = [&](uint32_t shading) {
                scene.render.shading = shading;
                const Simulation simulation(scene);
                Renderer renderer(device(), scene, simulation.capacity());
                Submission submission(device(), "shading");
                submitAndWait(renderer, submission, simulation, {&eye, 1});
                return bytesOf(submission.pictures()[0]);
            };
            const auto all = planesOf(1), some = planesOf(0);
            ASSERT_EQ(all.size(), some.size());
            const PlaneLayout layout{eye.width, eye.height};
            int worst = 0;
            double sum = 0;
            size_t count = 0;
            const auto compare = [&](size_t from, uint32_t stride, uint32_t width, uint32_t height) {
                for (uint32_t y = 0; y < height; ++y)
                    for (uint32_t x = 0; x < width; ++x, ++count) {
                        const size_t at = from + size_t(y) * stride + x;
                        const int off = std::abs(int(all[at]) - int(some[at]));
                        worst = std::max(worst, off);
                        sum += off;
                    }
            };
            compare(0, layout.lumaStride(), layout.width, layout.height);
            compare(layout.lumaBytes(), layout.chromaStride(), (layout.width + 1) / 2, layout.chromaHeight());
            compare(layout.lumaBytes() + layout.chromaBytes(), layout.chromaStride(), (layout.width + 1) / 2,
                    layout.chromaHeight());
            EXPECT_LE(worst, 1) << rate;
            EXPECT_LT(sum / double(count), 0.03) << rate;
        }
    }
}

// Methods that draw may draw every second, fourth or eighth pixel of a scene without objects: the cubic between them
// errs as the fourth power of their distance in standard deviations of the medium, which is 12 pixels here. Tetrahedra
// have edges; theirs is worse.
TEST_F(CoarseTest, DrawingSomePixelsIsAlmostDrawingAll) {
    const EyeRequest eye{lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), 641, 359};
    for (const char* method : {"sphere", "tiles", "isv"}) {
        Scene scene = loadScene("server/scenes/cloud.toml");
        scene.render.method = method;
        scene.render.shadow_size = 64;
        double before = 0;
        struct Seen {
            std::vector<glm::vec4> radiance;
            std::vector<uint8_t> planes;
        };
        const auto see = [&](uint32_t rate) {
            scene.render.rate = rate;
            const Simulation simulation(scene);
            Renderer renderer(device(), scene, simulation.capacity());
            renderer.keepRadiance(true);
            Submission submission(device(), "coarse");
            submitAndWait(renderer, submission, simulation, {&eye, 1});
            return Seen{renderer.readRadiance(), bytesOf(submission.pictures()[0])};
        };
        const Seen all = see(0);
        for (const uint32_t rate : {2u, 4u, 8u}) {
            const Seen some = see(rate);
            ASSERT_EQ(some.radiance.size(), all.radiance.size());
            double squares = 0, sum = 0, levels = 0;
            for (size_t i = 0; i < all.radiance.size(); ++i) {
                const glm::dvec3 a(all.radiance[i]), b(some.radiance[i]);
                squares += glm::dot(a - b, a - b), sum += glm::dot(a, a);
            }
            ASSERT_EQ(some.planes.size(), all.planes.size());
            const size_t luma = PlaneLayout{eye.width, eye.height}.lumaStride() * size_t(eye.height);
            for (size_t i = 0; i < luma; ++i)
                if (i % PlaneLayout{eye.width, eye.height}.lumaStride() < eye.width)
                    levels += std::abs(int(all.planes[i]) - int(some.planes[i]));
            const double error = std::sqrt(squares / sum);
            levels /= double(eye.width) * eye.height;
            EXPECT_LT(error, rate == 8 ? 1.5e-3 : 4e-4) << method << ' ' << rate;
            EXPECT_LT(levels, 0.03) << method << ' ' << rate;
            EXPECT_GT(error, before) << "every pixel further apart counts";
            before = error;
        }
    }
}

struct Off {
    double error; // relative RMSE
    double worst; // of a pixel, as a part of the brightest one
};
Off offOf(const std::vector<glm::vec4>& some, const std::vector<glm::vec4>& all) {
    double squares = 0, sum = 0, brightest = 0, worst = 0;
    for (size_t i = 0; i < all.size(); ++i) {
        const glm::dvec3 a(all[i]), b(some[i]);
        squares += glm::dot(a - b, a - b), sum += glm::dot(a, a);
        brightest = std::max(brightest, glm::dot(a, a)), worst = std::max(worst, glm::dot(a - b, a - b));
    }
    return {std::sqrt(squares / sum), std::sqrt(worst / brightest)};
}

// Of the last eye.
std::vector<glm::vec4> radianceOf(const gpu::Device& device, const Scene& scene, std::span<const EyeRequest> eyes) {
    const Simulation simulation(scene);
    Renderer renderer(device, scene, simulation.capacity());
    renderer.keepRadiance(true);
    Submission submission(device, "coarse");
    submitAndWait(renderer, submission, simulation, eyes);
    return renderer.readRadiance();
}

// With objects the medium alone is drawn at some pixels, and at all where surfaces or shadows end in it. These methods
// ask at two or five points of a particle whether light reaches it: in shafts of shadow their picture has steps from
// particle to particle that are part of their own error, 1.6 % against the reference and no larger with fewer pixels.
// Where such a step lies is all that changes: 0.5, 0.7 and 0.9 % were measured from outside, half of it from inside,
// and 5 % of the brightest at the worst pixel; with surfaces and shafts interpolated across it is 10, 14 and 17 %.
TEST_F(CoarseTest, DrawingSomePixelsKeepsEdgesOfObjectsAndShadows) {
    BRUME_WHOLE_LAYER_ONLY();
    Scene scene = loadScene("server/scenes/props.toml");
    scene.render.shadow_size = 64;
    const SceneCamera& camera = scene.camera;
    const glm::vec3 away = glm::normalize(camera.target - camera.position);
    for (const bool inside : {false, true})
        for (const char* method : {"sphere", "tiles", "isv"}) {
            const glm::vec3 from = inside ? scene.medium.centre : camera.position;
            const EyeRequest eye{lookAt(from, from + away, camera.fov_y), 641, 359};
            scene.render.method = method;
            scene.render.rate = 0;
            const auto all = radianceOf(device(), scene, {&eye, 1});
            for (const uint32_t rate : {2u, 4u, 8u}) {
                scene.render.rate = rate;
                const auto some = radianceOf(device(), scene, {&eye, 1});
                ASSERT_EQ(some.size(), all.size());
                const Off off = offOf(some, all);
                const double most = rate == 2 ? 0.006 : rate == 4 ? 0.008 : 0.011;
                EXPECT_LT(off.error, inside ? 0.5 * most : most) << method << ' ' << rate << (inside ? " inside" : "");
                EXPECT_GT(off.error, 1e-4) << method << ' ' << rate << ": were all drawn?";
                EXPECT_LT(off.worst, 0.06) << method << ' ' << rate << (inside ? " inside" : "");
            }
        }
}

// Naive: the medium in front of a surface is interpolated between coarse rays also where those end at very different
// depths, as on a ground that is seen along it. Rows of pixels are then bright and dark in turn beside a column of
// smoke. The measure is how far a row is from the mean of its neighbours: 0.03 with fine rays, 0.12 to 0.20 naively.
// 0.05 are left in one row, where the pixels' own depths begin to count.
TEST_F(CoarseTest, AGroundSeenAlongItHasNoCombs) {
    Scene scene = loadScene("server/scenes/plume.toml");
    scene.render.method = "slabs";
    scene.lights[0].to_light = glm::normalize(glm::vec3(0.94f, 0.087f, 0.33f));
    Simulation simulation(scene);
    for (int i = 0; i < 300; ++i) simulation.step({});
    const EyeRequest eye{lookAt({-4, 3.5f, 19}, {1.2f, 6.6f, 0}, 0.75f), 480, 270};
    const auto combs = [&](uint32_t rate, uint32_t slabs) {
        scene.render.rate = rate;
        scene.render.slabs = slabs;
        Renderer renderer(device(), scene, simulation.capacity());
        renderer.keepRadiance(true);
        Submission submission(device(), "combs");
        renderer.submit(submission, simulation, {&eye, 1}, &scene.render);
        waitFor(submission.commands);
        const auto radiance = renderer.readRadiance();
        float most = 0;
        for (size_t y = 200; y < 260; ++y) // the ground around the column's foot
            for (size_t x = 180; x < 280; ++x) {
                const auto at = [&](size_t row) { return radiance[row * eye.width + x].g; };
                most = std::max(most, std::abs(at(y) - 0.5f * (at(y - 1) + at(y + 1))));
            }
        return most;
    };
    const float fine = combs(1, 256);
    for (const uint32_t rate : {4u, 6u, 8u}) EXPECT_LT(combs(rate, 96), 2 * fine) << rate;
}

// The second eye of a head is drawn in the order of both, which changes as much as StereoTest.OneSortServesBothEyes
// says.
TEST_F(CoarseTest, TwoEyesDrawSomePixelsInOneOrder) {
    Scene scene = loadScene("server/scenes/props.toml");
    scene.render.shadow_size = 64;
    scene.render.rate = 4;
    Pose pose = lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y);
    pose.eye_separation = 0.064f;
    const std::array<EyeRequest, 2> eyes{EyeRequest{eyePose(pose, 0, 2), 160, 90},
                                         EyeRequest{eyePose(pose, 1, 2), 160, 90, true}};
    for (const char* method : {"sphere", "tiles"}) {
        scene.render.method = method;
        const auto both = radianceOf(device(), scene, eyes), alone = radianceOf(device(), scene, {&eyes[1], 1});
        ASSERT_EQ(both.size(), alone.size());
        EXPECT_LT(offOf(both, alone).error, 5e-4) << method;
    }
}

} // namespace
} // namespace brume::test::coarse_test
