// What the server measures of its own error is the error of the whole picture.
#include <thread>

#include <gtest/gtest.h>

#include "server/error/error_meter.h"
#include "server/inputs/eye_request.h"
#include "server/render/renderer.h"
#include "tests/gpu/fixture.h"
#include "tests/gpu/truth.h"
#include "tests/layer.h"

namespace brume::test::error_meter_test {
namespace {

using std::chrono::seconds;

constexpr glm::uvec2 kSize(96, 54);

// A clock that stands: what a slow machine measured does not grow old.
ErrorMeter::Time standing() { return ErrorMeter::Time{} + std::chrono::hours(1); }

class ErrorMeterTest : public GpuTest {
protected:
    // The way is coarse, so that there is something to measure.
    static Scene coarse(const char* name, const char* method) {
        Scene scene = loadScene(std::string("server/scenes/") + name + ".toml",
                                std::vector<std::string>{"render.method=" + std::string(method)});
        scene.render.rate = 8, scene.render.slabs = 12;
        scene.render.shadow_size = 32, scene.render.shadow_slices = 8;
        return scene;
    }
    static Pose poseOf(const Scene& scene) {
        return lookAt(scene.camera.position, scene.camera.target, scene.camera.fov_y);
    }
    static std::vector<gpu::Particle> particlesOf(const Simulation& simulation) {
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        return particles;
    }
    // Lets the meter measure `pictures` drawings of the same state, and more of them until it knows `pixels`: on a slow
    // machine it has time for few of each.
    void measure(ErrorMeter& meter, const Scene& scene, const Simulation& simulation, int pictures,
                 uint64_t version = 0, size_t pixels = 0) {
        const auto knows = [&] {
            const std::vector<ViewError> errors = meter.errors(standing());
            return errors.empty() ? 0 : errors[0].error.pixels;
        };
        Renderer renderer(device(), scene, simulation.capacity());
        Submission submission(device(), "meter");
        const EyeRequest eye{poseOf(scene), kSize.x, kSize.y};
        const uint32_t viewers[]{7};
        auto now = ErrorMeter::Time{} + seconds(1);
        for (int i = 0; i < pictures || (i < 200 && knows() < pixels); ++i) {
            std::unique_ptr<MeterJob> job;
            while (!(job = meter.begin(viewers, now += seconds(10)))) std::this_thread::yield();
            EXPECT_EQ(job->viewer, 7u);
            job->with = {scene.render, version};
            job->keeps = true;
            job->law = 0.01;
            job->scene = std::make_shared<const Scene>(scene);
            job->now = simulation.now();
            job->particles = particlesOf(simulation);
            job->pose = eye.pose;
            job->size = kSize;
            job->pixels = pixelsOf(job->pose, kSize, glm::vec3(-12), glm::vec3(12), job->number);
            submission.probe.pixels = job->pixels;
            submitAndWait(renderer, submission, simulation, {&eye, 1});
            job->values.assign(submission.probe.values().begin(), submission.probe.values().end());
            job->drawn = submission.probe.drawn;
            meter.give(std::move(job));
        }
        std::unique_ptr<MeterJob> next; // there is one when the last one is measured
        while (!(next = meter.begin(viewers, now += seconds(10)))) std::this_thread::yield();
        meter.drop(std::move(next));
    }
    // Of all the medium's pixels; without objects there are no edges.
    double wholeError(Scene scene, const Simulation& simulation) {
        scene.sky = {glm::vec3(0), glm::vec3(0), glm::vec3(0)};
        Renderer renderer(device(), scene, simulation.capacity());
        renderer.keepRadiance(true);
        Submission submission(device(), "whole");
        const EyeRequest eye{poseOf(scene), kSize.x, kSize.y};
        submitAndWait(renderer, submission, simulation, {&eye, 1});
        const std::vector<glm::vec4> drawn = renderer.readRadiance();
        const SceneNow& now = simulation.now();
        const reference::World world =
            reference::worldOf(scene, particlesOf(simulation),
                               {now.medium, now.light, now.lists.lights, now.lists.fogs, simulation.axes()});
        const reference::Picture truth =
            truePicture(world, reference::perspective(eye.pose, int(kSize.x), int(kSize.y), kNearDepth), 1e-5);
        std::vector<glm::dvec3> values, references;
        for (size_t i = 0; i < drawn.size(); ++i)
            if (truth.transmittance[i] < 0.999) {
                values.push_back(glm::dvec3(drawn[i]));
                references.push_back(truth.radiance[i]);
            }
        return reference::relativeRmse(values, references);
    }
};

TEST_F(ErrorMeterTest, MeasuresTheErrorOfTheWholePicture) {
    for (const auto& [name, method] : {std::pair("cloud", "slabs"), std::pair("cloud", "sphere")}) {
        SCOPED_TRACE(testing::Message() << name << ' ' << method);
        const Scene scene = coarse(name, method);
        const Simulation simulation(scene);
        ErrorMeter meter(1, &standing);
        measure(meter, scene, simulation, 8, 0, 500);
        const std::vector<ViewError> errors = meter.errors(standing());
        ASSERT_EQ(errors.size(), 1u);
        EXPECT_EQ(errors[0].viewer, 7u);
        EXPECT_EQ(errors[0].method, method);
        const ErrorEstimate& e = errors[0].error;
        const double whole = wholeError(scene, simulation);
        EXPECT_GT(whole, 2e-3);
        EXPECT_GE(e.pixels, 500u);
        EXPECT_NEAR(e.law, 0.01, 1e-9);
        if (std::string(method) == "slabs") {
            EXPECT_GE(whole, e.low);
            EXPECT_LE(whole, e.high);
        } else { // ambient light is in it, which dilutes the error
            EXPECT_LT(e.rmse, whole);
            EXPECT_GT(e.rmse, 0.3 * whole);
        }
    }
}

// A sheet in the middle of the medium fills the picture. It mirrors nothing, which would count as light of the medium.
TEST_F(ErrorMeterTest, ThroughGlass) {
    BRUME_WHOLE_LAYER_ONLY();
    for (const char* method : {"slabs", "tiles"}) {
        Scene scene = coarse("cloud", method);
        scene.sky.ambient = glm::vec3(0);
        scene.glasses = {{.width = 60, .height = 60, .transmittance = {1, 0.5f, 0.2f}, .reflectance = 0}};
        const Simulation simulation(scene);
        ErrorMeter meter(1, &standing);
        measure(meter, scene, simulation, 8, 0, 500);
        const std::vector<ViewError> errors = meter.errors(standing());
        ASSERT_EQ(errors.size(), 1u);
        const double whole = wholeError(scene, simulation);
        EXPECT_GT(whole, 2e-3) << method;
        EXPECT_GE(errors[0].error.pixels, 500u) << method;
        EXPECT_GE(whole, errors[0].error.low) << method;
        EXPECT_LE(whole, errors[0].error.high) << method;
    }
}

// Objects throw shadows through the medium and hide it. Edges are left out.
TEST_F(ErrorMeterTest, WhatIsWellDrawnHasASmallError) {
    Scene scene = loadScene("server/scenes/props.toml", std::vector<std::string>{"render.method=slabs"});
    scene.render.rate = 1, scene.render.slabs = 128, scene.render.shadow_error = 5e-4f;
    const Simulation simulation(scene);
    ErrorMeter meter(1, &standing);
    measure(meter, scene, simulation, 3, 0, 51);
    const std::vector<ViewError> errors = meter.errors(standing());
    ASSERT_EQ(errors.size(), 1u);
    EXPECT_LT(errors[0].error.rmse, 3e-3);
    EXPECT_GT(errors[0].error.rmse, 1e-5);
    EXPECT_GT(errors[0].error.pixels, 50u);
}

TEST_F(ErrorMeterTest, WhoHasLeftAndAnotherSceneAreForgotten) {
    const Scene scene = coarse("cloud", "slabs");
    const Simulation simulation(scene);
    ErrorMeter meter(1, &standing);
    const auto known = [&] { return meter.errors(standing()).size(); };
    measure(meter, scene, simulation, 1);
    EXPECT_EQ(known(), 1u);
    const uint32_t here[]{7}, others[]{3, 9};
    meter.stay(here);
    EXPECT_EQ(known(), 1u);
    meter.stay(others);
    EXPECT_EQ(known(), 0u);
}

// Pixels of pictures that were drawn otherwise are not shown among those of present ones.
TEST_F(ErrorMeterTest, SinglePixelsAreOfPicturesThatAreDrawnAlike) {
    Scene scene = coarse("cloud", "slabs");
    const Simulation simulation(scene);
    ErrorMeter meter(1, &standing);
    const auto shown = [&](const RenderSettings& settings, uint64_t version) {
        std::vector<gpu::ErrorDisc> discs;
        meter.shown(7, poseOf(scene), {settings, version}, standing(), discs);
        return discs.size();
    };
    const RenderSettings first = scene.render;
    measure(meter, scene, simulation, 2);
    const size_t before = shown(first, 0);
    EXPECT_GT(before, 50u);
    EXPECT_EQ(shown(first, 1), 0u) << "a setting of the medium, say";
    scene.render.method = "grid";
    EXPECT_EQ(shown(scene.render, 0), 0u);
    scene.render = first, scene.render.rate = 4;
    EXPECT_EQ(shown(scene.render, 0), 0u);
    measure(meter, scene, simulation, 1, 1);
    EXPECT_GT(shown(scene.render, 1), 20u);
    EXPECT_LT(shown(scene.render, 1), before);
    EXPECT_EQ(shown(first, 0), before) << "they are there again when the settings are";
}

TEST_F(ErrorMeterTest, WithoutAShareItMeasuresNothing) {
    ErrorMeter meter(0);
    const uint32_t viewers[]{7};
    EXPECT_EQ(meter.begin(viewers, ErrorMeter::Time{} + seconds(1)), nullptr);
}

} // namespace
} // namespace brume::test::error_meter_test
