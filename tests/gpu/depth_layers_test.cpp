// Layers with depth, from which viewers redraw a picture: what they are together, where they lie, and that pictures
// beside them are what they are without.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "common/redraw.h"
#include "server/methods/plans.h"
#include "shaders/shared/depth_layers.h"
#include "tests/gpu/fixture.h"

namespace brume::test::depth_layers_test {
namespace {

constexpr uint32_t kWidth = 160, kHeight = 92;

class DepthLayersTest : public GpuTest {
protected:
    // A picture of a shipped scene with its layers, which live as long as it.
    struct Drawn {
        std::unique_ptr<Renderer> renderer;
        std::unique_ptr<Submission> submission;
        Pose eye;
        std::vector<uint8_t> planes;
        DepthLayersView layers;

        uint32_t at(const uint8_t* plane, uint32_t layer, uint32_t column, uint32_t row) const {
            return plane[size_t(layer * layers.block_rows + row) * layers.colours.layout.lumaStride() + column];
        }
        float transmittance(uint32_t layer, uint32_t column, uint32_t row) const {
            return float(at(layers.data, layer, column, row)) / 255;
        }
        float depth(uint32_t layer, uint32_t column, uint32_t row) const {
            const uint8_t* depths =
                layers.data + size_t(layers.count) * layers.block_rows * layers.colours.layout.lumaStride();
            return layers.near * std::pow(layers.far / layers.near, float(at(depths, layer, column, row)) / 255);
        }
    };
    static Drawn drawn(const char* name, uint32_t layers, const std::vector<std::string>& set = {}) {
        Scene scene = loadScene("server/scenes/" + std::string(name) + ".toml", set);
        scene.render.method = "slabs";
        scene.render.rate = 4, scene.render.slabs = 32;
        const Simulation simulation(scene);
        Drawn out;
        out.eye = lookAt(scene.camera.position, scene.camera.target, 0.8f);
        out.renderer = std::make_unique<Renderer>(device(), scene, simulation.capacity());
        out.submission = std::make_unique<Submission>(device(), "layers");
        const EyeRequest eyes[]{{.pose = out.eye, .width = kWidth, .height = kHeight, .depth_layers = layers}};
        submitAndWait(*out.renderer, *out.submission, simulation, eyes);
        const PictureView picture = out.submission->pictures().front();
        out.planes.assign(picture.bytes, picture.bytes + picture.layout.bytes());
        out.layers = out.submission->layers().front();
        return out;
    }
};

TEST_F(DepthLayersTest, APictureIsTheSameWithAndWithoutThem) {
    for (const char* name : {"cloud", "props"}) {
        const Drawn without = drawn(name, 0), with = drawn(name, 4);
        EXPECT_EQ(without.planes, with.planes) << name;
        EXPECT_EQ(without.layers.count, 0u);
        EXPECT_EQ(with.layers.count, 4u);
    }
}

// In front of each other the layers let through what one layer does, and hide equally much.
TEST_F(DepthLayersTest, AreThePartsOfOne) {
    const Drawn one = drawn("cloud", 1), four = drawn("cloud", 4);
    const DepthLayersView& layers = four.layers;
    ASSERT_EQ(layers.columns, one.layers.columns);
    uint32_t dense = 0;
    for (uint32_t row = 0; row < layers.rows; ++row)
        for (uint32_t column = 0; column < layers.columns; ++column) {
            float through = 1, before = 0;
            std::vector<float> hidden;
            for (uint32_t k = 0; k < 4; ++k) {
                hidden.push_back(through * (1 - four.transmittance(k, column, row)));
                through *= four.transmittance(k, column, row);
            }
            const float whole = one.transmittance(0, column, row);
            ASSERT_NEAR(through, whole, 0.01f) << column << ' ' << row;
            if (whole > 0.5f) continue;
            ++dense;
            for (uint32_t k = 0; k < 4; ++k) {
                EXPECT_NEAR(hidden[k], (1 - whole) / 4, 0.03f) << column << ' ' << row << ' ' << k;
                EXPECT_GE(four.depth(k, column, row), before) << "near to far";
                before = four.depth(k, column, row);
            }
            EXPECT_GT(one.depth(0, column, row), four.depth(0, column, row));
            EXPECT_LT(one.depth(0, column, row), four.depth(3, column, row));
        }
    EXPECT_GT(dense, 100u);
}

// One thin particle: its only layer lies at its centre, wherever it is.
TEST_F(DepthLayersTest, LieWhereTheMediumIs) {
    for (const float z : {0.0f, -6.0f}) {
        Scene scene = brume::test::sceneOf({{{0, 0, z}, 8, 0.02f}, {{0, 0, -20}, 8, 1e-6f}});
        scene.render.method = "slabs", scene.render.rate = 4, scene.render.slabs = 64;
        const Simulation simulation(scene);
        Renderer renderer(device(), scene, simulation.capacity());
        Submission submission(device(), "layers");
        const EyeRequest eyes[]{
            {.pose = lookAt({0, 0, 10}, {0, 0, 0}, 0.8f), .width = kWidth, .height = kHeight, .depth_layers = 1}};
        submitAndWait(renderer, submission, simulation, eyes);
        submission.pictures();
        Drawn one;
        one.layers = submission.layers().front();
        const float scale = one.layers.spacing, column = (kWidth / 2.0f - one.layers.first) / scale,
                    row = (kHeight / 2.0f - one.layers.first) / scale;
        EXPECT_NEAR(one.depth(0, uint32_t(column), uint32_t(row)), 10 - z, 0.15f);
    }
}

// From where it was drawn a picture is what it was, with layers of the device as with any (tests/unit/redraw_test.cpp).
// Surfaces say where they are: the ground in `props`, and the sky.
TEST_F(DepthLayersTest, SurfacesHaveTheirDepth) {
    const Drawn props = drawn("props", 2), cloud = drawn("cloud", 2);
    EXPECT_EQ(cloud.layers.surface, nullptr) << "nothing but sky";
    ASSERT_NE(props.layers.surface, nullptr);
    const Scene scene = loadScene("server/scenes/props.toml");
    ASSERT_FALSE(scene.planes.empty());
    const Frustum frustum = frustumOf(props.eye, kWidth, kHeight);
    uint32_t ground = 0;
    for (const uint32_t x : {4u, kWidth - 4}) {
        const float right = -frustum.left + (frustum.left + frustum.right) * (float(x) + 0.5f) / kWidth;
        const float up = frustum.up - (frustum.up + frustum.down) * (kHeight - 2 + 0.5f) / kHeight;
        const glm::vec3 ray = props.eye.orientation * glm::vec3(right, up, -1);
        const float depth = (scene.planes.front().height - props.eye.position.y) / ray.y;
        const uint8_t byte = props.layers.surface[size_t(kHeight - 2) * PlaneLayout{kWidth, kHeight}.lumaStride() + x];
        if (byte == gpu::kSkyByte) continue;
        ++ground;
        EXPECT_NEAR(gpu::surfaceDepth(byte) / depth, 1, 0.02f) << x;
    }
    EXPECT_GT(ground, 0u);
    EXPECT_EQ(props.layers.surface[0], gpu::kSkyByte);
}

// A layer has one transmittance for all channels.
TEST_F(DepthLayersTest, OfColouredExtinctionThereAreNone) {
    const Drawn coloured = drawn("cloud", 4, {"medium.extinction_colour=[1,0.5,0.25]"});
    EXPECT_EQ(coloured.layers.count, 0u);
    EXPECT_EQ(coloured.layers.surface, nullptr);
}

// Methods without rays, and glass, have none: pictures come without, and nothing fails.
TEST_F(DepthLayersTest, OfOtherMethodsThereAreNone) {
    Scene scene = loadScene("server/scenes/cloud.toml");
    scene.render.method = "tiles";
    const Simulation simulation(scene);
    Renderer renderer(device(), scene, simulation.capacity());
    Submission submission(device(), "layers");
    const EyeRequest eyes[]{{.pose = lookAt(scene.camera.position, scene.camera.target, 0.8f),
                             .width = kWidth,
                             .height = kHeight,
                             .depth_layers = 4}};
    submitAndWait(renderer, submission, simulation, eyes);
    EXPECT_EQ(submission.layers().front().count, 0u);
    EXPECT_EQ(submission.layers().front().surface, nullptr);
}

} // namespace
} // namespace brume::test::depth_layers_test
