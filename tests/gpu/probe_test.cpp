// Probed pixels are those of the picture.
#include <gtest/gtest.h>

#include "server/render/renderer.h"
#include "tests/gpu/fixture.h"

namespace brume::test::probe_test {
namespace {

class ProbeTest : public GpuTest {
protected:
    // Without sky and ambient light, with black objects: what is behind the medium gives no light.
    static Scene alone(const char* name, const char* method) {
        std::vector<std::string> overrides{"sky.zenith=[0,0,0]", "sky.horizon=[0,0,0]", "sky.ambient=[0,0,0]",
                                           "render.shadow_size=64"};
        overrides.push_back("render.method=" + std::string(method));
        Scene scene = loadScene(std::string("server/scenes/") + name + ".toml", overrides);
        for (Plane& plane : scene.planes) plane.albedo = glm::vec3(0);
        for (Box& box : scene.boxes) box.albedo = glm::vec3(0);
        for (Sphere& sphere : scene.spheres) sphere.albedo = glm::vec3(0);
        return scene;
    }
};

std::vector<glm::uvec2> somePixels(uint32_t width, uint32_t height) {
    std::vector<glm::uvec2> pixels{{0, 0}, {width - 1, 0}, {0, height - 1}, {width - 1, height - 1}};
    for (uint32_t i = 0; pixels.size() < 64; ++i) pixels.push_back(glm::uvec2(i * 37 % width, i * 23 % height));
    return pixels;
}

// The eye that is probed is the second of three, with a size and a rate of its own.
TEST_F(ProbeTest, ReadsTheRadianceOfThePicture) {
    struct Way {
        const char *scene, *method;
        uint32_t rate;
    };
    for (const Way& way :
         {Way{"cloud", "slabs", 1}, Way{"cloud", "slabs", 6}, Way{"cloud", "grid", 4}, Way{"cloud", "tiles", 0},
          Way{"cloud", "tiles", 4}, Way{"props", "slabs", 4}, Way{"props", "tiles", 0}}) {
        SCOPED_TRACE(testing::Message() << way.scene << ' ' << way.method << ' ' << way.rate);
        Scene scene = alone(way.scene, way.method);
        scene.render.rate = way.rate;
        Simulation simulation(scene);
        for (int tick = 0; tick < 30; ++tick) simulation.step({});
        const Pose own = lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y);
        Pose other = own;
        other.position += glm::vec3(1, 0.5f, 0);
        const EyeRequest eyes[]{{own, 64, 36}, {other, 161, 90}, {own, 320, 180}};
        Renderer renderer(device(), scene, simulation.capacity());
        Submission submission(device(), "probe");
        submission.probe.eye = 1;
        submission.probe.pixels = somePixels(161, 90);
        submitAndWait(renderer, submission, simulation, eyes);
        const std::vector<glm::vec4> values(submission.probe.values().begin(), submission.probe.values().end());
        ASSERT_EQ(values.size(), submission.probe.pixels.size());

        renderer.keepRadiance(true);
        const std::vector<glm::uvec2> pixels = std::exchange(submission.probe.pixels, {});
        submitAndWait(renderer, submission, simulation, {&eyes[1], 1});
        const std::vector<glm::vec4> picture = renderer.readRadiance();
        float brightest = 0, difference = 0;
        for (const glm::vec4& value : picture) brightest = std::max(brightest, value.g);
        for (size_t i = 0; i < pixels.size(); ++i) {
            const glm::vec4 apart = glm::abs(values[i] - picture[size_t(pixels[i].y) * 161 + pixels[i].x]);
            difference = std::max({difference, apart.r / brightest, apart.g / brightest, apart.b / brightest, apart.a});
        }
        EXPECT_GT(brightest, 0.01f);
        EXPECT_LT(difference, 2e-5f);
        EXPECT_TRUE(submission.probe.values().empty());
    }
}

// Ambient light and sky stay out where the medium is a field; where it is drawn they are in it.
TEST_F(ProbeTest, SaysWhetherTheMediumIsAlone) {
    for (const bool drawn : {false, true}) {
        Scene bright = alone("cloud", drawn ? "sphere" : "slabs"), dark = bright;
        bright.sky = {glm::vec3(3), glm::vec3(2), glm::vec3(1)};
        std::vector<glm::vec4> values[2];
        for (const bool light : {false, true}) {
            const Simulation simulation(light ? bright : dark);
            Renderer renderer(device(), light ? bright : dark, simulation.capacity());
            Submission submission(device(), "probe");
            const EyeRequest eye{lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), 160, 90};
            submission.probe.pixels = somePixels(160, 90);
            submitAndWait(renderer, submission, simulation, {&eye, 1});
            EXPECT_EQ(submission.probe.drawn, drawn);
            values[light].assign(submission.probe.values().begin(), submission.probe.values().end());
        }
        EXPECT_EQ(values[0] == values[1], !drawn);
    }
}

TEST_F(ProbeTest, TooManyAreRefused) {
    const Scene scene = alone("cloud", "slabs");
    const Simulation simulation(scene);
    Renderer renderer(device(), scene, simulation.capacity());
    Submission submission(device(), "probe");
    submission.probe.pixels.resize(kMostProbes + 1);
    const EyeRequest eye{lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), 160, 90};
    EXPECT_THROW(renderer.submit(submission, simulation, {&eye, 1}), gpu::Error);
}

} // namespace
} // namespace brume::test::probe_test
