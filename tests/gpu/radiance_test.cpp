// Method gradients: light that is interpolated between few places, against light that is computed at every node.
#include <gtest/gtest.h>

#include "tests/gpu/judged.h"
#include "tests/layer.h"

namespace brume::test::radiance_test {
namespace {

const Pose kPose = lookAt({2, 1.5f, 7}, {0, 0, 0}, 0.9f);

class RadianceTest : public JudgedTest {
protected:
    // Smoke that a point in it and a spot beside it light, past a box.
    static Scene smoke() {
        Scene scene = sceneOf(randomPoints(80, 4, 3, 0.9f), 1);
        scene.lights = {{.type = kPoint, .position = {0.7f, 0.4f, 0.3f}, .intensity = {9, 8, 6}},
                        {.type = kSpot, .position = {-4, 3, 1}, .intensity = {10, 60, 90}}};
        scene.lights[1].axis = glm::normalize(glm::vec3(4, -3, -1));
        scene.boxes = {{{-1, 0.8f, 0.2f}, {0.8f, 0.8f, 0.8f}, 0.4f, glm::vec3(0.3f)}};
        scene.render.method = "gradients";
        scene.render.froxels = {.pixels = 1, .slices = 128};
        return scene;
    }
    static double difference(const Picture& a, const Picture& b) {
        double off = 0, all = 0;
        for (size_t i = 0; i < a.pixels.size(); ++i) {
            const glm::dvec3 p(a.pixels[i]), q(b.pixels[i]);
            off += glm::dot(p - q, p - q), all += glm::dot(q, q);
        }
        return std::sqrt(off / all);
    }
    // Pictures of one scene with many settings, and the work that its shaders count.
    class Seen {
    public:
        explicit Seen(const Scene& scene) : renderer_(device(), scene, 600), submission_(device(), "test") {
            renderer_.keepRadiance(true);
        }
        Picture see(const Scene& scene) {
            const std::vector<EyeRequest> eyes{{.pose = kPose, .width = 96, .height = 64}};
            const LightWork before = renderer_.countLightWork();
            submitAndWait(renderer_, submission_, Simulation(scene), eyes);
            work = renderer_.countLightWork() - before;
            return {96, 64, renderer_.readRadiance()};
        }
        LightWork work; // of the last picture

    private:
        Renderer renderer_;
        Submission submission_;
    };
};

// Marches toward the lights and look-ups in their volumes agree with the reference at every node.
TEST_F(RadianceTest, EveryNodeAgreesWithTheReference) {
    Scene scene = smoke();
    scene.render.radiance.interpolation = "exact";
    scene.render.froxels.slices = 256;
    for (const float step : {0.0f, 0.5f}) {
        scene.render.radiance.step = step;
        const Error error = errorOf(scene, kPose);
        std::printf("step %.1f: %.3f %%, worst pixel %.2f %%\n", double(step), 100 * error.rmse, 100 * error.worst);
        EXPECT_LE(error.rmse, 0.02) << step;
    }
}

// Nested grids err less than samples in spheres, with fewer places. Of the factor planes err less than means; of
// radiance, which falls with the square of the distance, they do not always.
TEST_F(RadianceTest, InterpolationErrs) {
    Scene scene = smoke();
    Seen seen(scene);
    Picture exact;
    const auto errorBy = [&](const char* interpolation, double allowed) {
        scene.render.radiance.interpolation = interpolation;
        const double error = difference(seen.see(scene), exact);
        std::printf("%-8s of %-8s %.3f %%, %llu places, %llu samples, %llu nodes\n", interpolation,
                    scene.render.radiance.quantity.c_str(), 100 * error, (unsigned long long)seen.work.places,
                    (unsigned long long)seen.work.samples, (unsigned long long)seen.work.nodes);
        EXPECT_LE(error, allowed) << interpolation << " of " << scene.render.radiance.quantity;
        EXPECT_GE(error, allowed / 2) << "nothing is interpolated";
        EXPECT_GT(seen.work.samples, 0u);
        return error;
    };
    for (const char* quantity : {"radiance", "factor"}) {
        scene.render.radiance.quantity = quantity;
        scene.render.radiance.near = scene.render.radiance.quantity == "radiance" ? 0 : 3; // all light, as printed
        scene.render.radiance.interpolation = "exact";
        exact = seen.see(scene);
        const uint64_t all = seen.work.places;
        // A quarter more than measured.
        const bool factor = scene.render.radiance.quantity == "factor";
        const double rbf = errorBy("rbf", factor ? 0.018 : 0.081),
                     gradient = errorBy("gradient", factor ? 0.0085 : 0.12), nested = errorBy("nested", 0.002);
        if (factor) {
            EXPECT_LT(gradient, rbf);
        }
        EXPECT_LT(nested, std::min(rbf, gradient) / 4) << quantity;
        EXPECT_LT(seen.work.places, all / 2) << quantity;
    }
}

// The factor of every node times all light is that light: method lit computes it at once.
TEST_F(RadianceTest, TheFactorTimesAllLightIsLight) {
    Scene scene = smoke();
    scene.render.radiance.interpolation = "exact";
    const Picture factor = render(device(), scene, kPose, 96, 64);
    scene.render.method = "lit";
    const Picture lit = render(device(), scene, kPose, 96, 64);
    const double off = difference(factor, lit);
    std::printf("%.4f %%\n", 100 * off);
    EXPECT_LE(off, 0.01);
}

// Where every node is computed, nested grids are no other than all nodes.
TEST_F(RadianceTest, OneLevelOfNestedGridsIsExact) {
    Scene scene = smoke();
    Seen seen(scene);
    scene.render.radiance.interpolation = "exact";
    const Picture exact = seen.see(scene);
    scene.render.radiance.interpolation = "nested";
    scene.render.radiance.levels = 1;
    EXPECT_EQ(seen.see(scene).pixels, exact.pixels);
    double before = 1;
    uint64_t places = 0;
    scene.render.radiance.levels = 3;
    for (const float allowed : {0.3f, 0.03f, 0.003f}) {
        scene.render.radiance.error = allowed;
        const double error = difference(seen.see(scene), exact);
        EXPECT_LE(error, before) << allowed;
        EXPECT_GE(seen.work.places, places) << allowed;
        before = error, places = seen.work.places;
    }
}

// Samples that are dropped leave no place in the medium without light; as printed they do, and pixels are dark there.
TEST_F(RadianceTest, ThereAreNoHoles) {
    BRUME_WHOLE_LAYER_ONLY();
    // Of pixels that show light, the least part that a picture has of the light of another.
    const auto least = [](const Picture& picture, const Picture& exact) {
        float brightest = 0;
        for (const glm::vec4& pixel : exact.pixels) brightest = std::max(brightest, pixel.r);
        float part = 1;
        for (size_t i = 0; i < exact.pixels.size(); ++i)
            if (exact.pixels[i].r > 0.01f * brightest) part = std::min(part, picture.pixels[i].r / exact.pixels[i].r);
        return part;
    };
    Random random(3);
    std::optional<Seen> seen;
    uint64_t printed_holes = 0, nodes = 0;
    float darkest = 1, darkest_printed = 1;
    const uint32_t scenes = whole() ? 100 : 16;
    for (uint32_t i = 0; i < scenes; ++i) {
        Scene scene =
            sceneOf(randomPoints(40, random.uniform(1, 6), random.uniform(0.5f, 4), random.uniform(0.2f, 4), i));
        scene.lights = {{.type = kPoint, .position = random.inCube(4), .intensity = glm::vec3(9)},
                        {.type = kSpot, .position = random.inCube(6), .intensity = glm::vec3(40)}};
        scene.lights[1].axis = glm::normalize(-scene.lights[1].position);
        scene.render.method = "gradients";
        scene.render.froxels = {.pixels = 16, .slices = 8};
        scene.render.radiance.quantity = i % 2 == 0 ? "radiance" : "factor";
        scene.render.radiance.near = i % 2 == 0 ? 0 : 3;
        scene.render.radiance.error = random.uniform(0.001f, 0.05f);
        if (!seen) seen.emplace(scene);
        scene.render.radiance.interpolation = "exact";
        const Picture exact = seen->see(scene);
        scene.render.radiance.interpolation = "gradient";
        const Picture interpolated = seen->see(scene);
        EXPECT_EQ(seen->work.holes, 0u) << i;
        nodes += seen->work.nodes;
        for (const glm::vec4& pixel : interpolated.pixels) ASSERT_TRUE(std::isfinite(pixel.x + pixel.a)) << i;
        darkest = std::min(darkest, least(interpolated, exact));
        if (scene.render.radiance.quantity == "factor") {
            EXPECT_LE(difference(interpolated, exact), 0.25) << i;
        }
        scene.render.radiance.weights = "printed";
        const Picture printed = seen->see(scene);
        printed_holes += seen->work.holes;
        darkest_printed = std::min(darkest_printed, least(printed, exact));
    }
    std::printf("%llu nodes computed alone, %llu holes as printed; least part of the light %.3f, as printed %.3f\n",
                (unsigned long long)nodes, (unsigned long long)printed_holes, double(darkest), double(darkest_printed));
    // Interpolated light errs, down to a seventh of what there is. A hole has none.
    EXPECT_GT(darkest, 0.1f);
    EXPECT_LT(darkest_printed, 0.01f) << "this test sees no holes";
    EXPECT_GT(nodes, 0u);
    EXPECT_GT(printed_holes, 0u);
}

// A lamp on a node, and one that sends nothing there: light is a number, and that of the others.
TEST_F(RadianceTest, LampsOnNodesAndLampsThatAreOut) {
    Scene scene = smoke();
    scene.boxes.clear();
    scene.lights = {{.type = kPoint, .position = {0.5f, 0.25f, 0.75f}, .intensity = glm::vec3(1)},
                    {.type = kPoint, .position = {8, 0, 0}, .intensity = glm::vec3(1e4f), .range = 2}};
    Seen seen(scene);
    for (const char* quantity : {"radiance", "factor"}) {
        scene.render.radiance = {.interpolation = "exact", .quantity = quantity, .near = 3, .spacing = 0.25f};
        if (scene.render.radiance.quantity == "radiance") scene.render.radiance.near = 0;
        const Picture exact = seen.see(scene);
        for (const glm::vec4& pixel : exact.pixels) ASSERT_TRUE(std::isfinite(pixel.x + pixel.a)) << quantity;
        scene.render.radiance.interpolation = "nested";
        EXPECT_LE(difference(seen.see(scene), exact), 0.03) << quantity;
        Scene alone = scene;
        alone.lights.pop_back();
        alone.render.radiance.interpolation = "exact";
        EXPECT_LE(difference(exact, seen.see(alone)), 1e-4) << quantity;
    }
}

// Nothing is computed while nothing changes; settings that change count as much as lights.
TEST_F(RadianceTest, AtRestNothingIsComputed) {
    Scene scene = smoke();
    Seen seen(scene);
    seen.see(scene);
    EXPECT_GT(seen.work.places, 0u);
    seen.see(scene);
    EXPECT_EQ(seen.work.places, 0u);
    scene.render.radiance.error = 0.5f;
    seen.see(scene);
    EXPECT_GT(seen.work.places, 0u);
}

// Light near a point is added exactly, whatever is interpolated, unless none is near.
TEST_F(RadianceTest, NearLightIsExactWithRadianceToo) {
    Scene scene = smoke();
    Seen seen(scene);
    Picture exact;
    double off[2][2];
    for (const int radiance : {0, 1})
        for (const int near : {0, 1}) {
            scene.render.radiance.quantity = radiance ? "radiance" : "factor";
            scene.render.radiance.near = near ? 3 : 0;
            scene.render.radiance.interpolation = "exact";
            exact = seen.see(scene);
            scene.render.radiance.interpolation = "rbf";
            off[radiance][near] = difference(seen.see(scene), exact);
            std::printf("%s, near %d: %.3f %%\n", scene.render.radiance.quantity.c_str(), 3 * near,
                        100 * off[radiance][near]);
        }
    EXPECT_LT(off[1][1], off[1][0] / 2) << "1/d^2 beside the light is what means miss";
    EXPECT_LT(off[0][0], off[1][0]);
}

} // namespace
} // namespace brume::test::radiance_test
