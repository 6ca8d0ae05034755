// Pictures of which fewer pixels are shaded or drawn than they have.
#include <algorithm>
#include <cmath>

#include "tests/gpu/fixture.h"

namespace brume::test {
namespace {

class CoarseTest : public GpuTest {};

std::vector<uint8_t> bytesOf(const PictureView& picture) { return {picture.bytes, picture.bytes + picture.layout.bytes()}; }

// Pixels between shaded ones follow by interpolation. The bound is of rounding: two values that differ by less than half a level
// may become neighbouring bytes, no others.
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

// Methods that draw may draw every second, fourth or eighth pixel of a scene without objects: the cubic between them errs as the
// fourth power of their distance in standard deviations of the medium, which is 12 pixels here. Tetrahedra have edges; theirs is
// worse.
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

} // namespace
} // namespace brume::test
