// What pictures and settings leave behind in memory: of the device, and of the process with the driver in it.
#include <fstream>

#include <unistd.h>

#include "server/effects/propagation/propagation_plan.h"
#include "server/gpu/pipeline_cache.h"
#include "server/inputs/hues.h"
#include "server/plan/memory.h"
#include "server/render/idle_memory.h"
#include "tests/gpu/fixture.h"
#include "tests/gpu/light_passes.h"
#include "tests/gpu/quadrature.h"
#include "tests/layer.h"

namespace brume::test::memory_test {
namespace {

uint64_t residentBytes() {
    uint64_t all = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> all >> resident;
    return resident * uint64_t(::sysconf(_SC_PAGESIZE));
}

EyeRequest eyeOf(uint32_t width, uint32_t height) {
    return {lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), width, height, false, 8};
}

class MemoryTest : public GpuTest {
protected:
    void draw(std::span<const EyeRequest> eyes) {
        renderer_.submit(submission_, simulation_, eyes, &settings_);
        waitFor(submission_.commands);
    }
    static Scene rasterised(const char* file) {
        Scene scene = loadScene(file);
        scene.render.method = "sphere";
        return scene;
    }

    const Scene scene_ = rasterised("server/scenes/cloud.toml");
    const Simulation simulation_{scene_};
    RenderSettings settings_ = scene_.render;
    Renderer renderer_{device(), scene_, simulation_.capacity()};
    Submission submission_{device(), "memory"};
};

// A viewer that asks for a wide picture and then for a high one takes what one of them needs.
TEST_F(MemoryTest, AWidePictureAndAHighOneTakeTheMemoryOfOne) {
    const EyeRequest wide = eyeOf(1920, 64), high = eyeOf(64, 1920);
    draw({&wide, 1});
    const uint64_t of_wide = device().memoryInUse();
    draw({&high, 1});
    EXPECT_LE(device().memoryInUse(), of_wide + (64 << 10));
    const EyeRequest both[] = {wide, high, wide};
    draw(both);
    EXPECT_LE(device().memoryInUse(), of_wide + 3ull * 2 * 1920 * 64 * 3); // the planes of two more
}

// Targets share memory, and a picture is the same whatever was drawn there before it.
TEST_F(MemoryTest, PicturesOfManyShapesInOneSubmissionAreThoseOfEachAlone) {
    const EyeRequest eyes[] = {eyeOf(160, 32), eyeOf(32, 160), eyeOf(96, 64), eyeOf(160, 32)};
    std::vector<std::vector<uint8_t>> alone;
    const auto bytesOf = [](const PictureView& view) {
        return std::vector<uint8_t>(view.bytes, view.bytes + view.layout.bytes());
    };
    for (const EyeRequest& eye : eyes) {
        draw({&eye, 1});
        alone.push_back(bytesOf(submission_.pictures().front()));
    }
    draw(eyes);
    for (size_t i = 0; i < std::size(eyes); ++i) EXPECT_EQ(bytesOf(submission_.pictures()[i]), alone[i]) << i;
}

// Shaders stay compiled for points and spots when the last one is removed, and go on to write what those light.
TEST_F(MemoryTest, ThereIsRoomForLocalLightWithoutLights) {
    Scene scene = scene_;
    scene.medium.layout = Layout::none;
    scene.fogs = {{.extinction = 0.05f}, {.extinction = 0.05f, .radius = 3}};
    scene.render.method = "slabs";
    const SceneFeatures compiled{.opaque = true, .fog = true, .local_lights = true};
    const Simulation simulation(scene);
    Renderer renderer(device(), scene, simulation.capacity(), compiled);
    const EyeRequest eye = eyeOf(320, 180);
    submitAndWait(renderer, submission_, simulation, {&eye, 1});
    EXPECT_GE(renderer.pictureBytes(), Renderer::pictureBytes({&eye, 1}, false, compiled));
}

TEST_F(MemoryTest, WhatPicturesTookIsGivenBack) {
    const EyeRequest small = eyeOf(64, 36), large = eyeOf(960, 540);
    draw({&small, 1});
    renderer_.giveBack();
    submission_.giveBack();
    const uint64_t before = device().memoryInUse();
    draw({&large, 1});
    EXPECT_GE(renderer_.pictureBytes(), Renderer::pictureBytes({&large, 1}, false, {}));
    EXPECT_GT(device().memoryInUse(), before + 20ull * 960 * 540);
    renderer_.giveBack();
    submission_.giveBack();
    EXPECT_EQ(renderer_.pictureBytes(), 0u);
    EXPECT_LE(device().memoryInUse(), before);
    draw({&small, 1}); // goes on
    EXPECT_GT(renderer_.pictureBytes(), 0u);
}

// The light of lamps and the sun's shafts are kept for every pixel: these bytes count, and go with the others.
TEST_F(MemoryTest, LightThatIsKeptForEachPixelCounts) {
    constexpr uint64_t kPixels = 960ull * 540;
    const EyeRequest large = eyeOf(960, 540);
    uint64_t dark = 0;
    for (const bool lit : {false, true}) {
        Scene scene = loadScene("server/scenes/cloud.toml");
        scene.render.method = "slabs";
        scene.boxes = {{{0, 8, 0}, {1, 1, 1}, 0, glm::vec3(0.5f)}};
        if (lit)
            scene.lights.push_back({.type = kPoint, .position = {3, 3, 3}, .intensity = glm::vec3(20), .range = 4});
        else
            scene.lights.clear();
        const Simulation simulation(scene);
        Renderer renderer(device(), scene, simulation.capacity());
        Submission submission(device(), "light");
        submitAndWait(renderer, submission, simulation, {&large, 1});
        const SceneFeatures features = featuresOf(scene, simulation.now());
        EXPECT_EQ(features.casters && features.local_lights, lit);
        const uint64_t planes = PlaneLayout{960, 540, false}.bytes();
        EXPECT_GE(renderer.pictureBytes(), Renderer::pictureBytes({&large, 1}, false, features));
        EXPECT_LE(renderer.pictureBytes(), Renderer::mostBytesOfPixel(features) * kPixels + planes);
        if (lit)
            EXPECT_GE(renderer.pictureBytes(), dark + kPixels * 24);
        else
            dark = renderer.pictureBytes();
        renderer.giveBack();
        EXPECT_EQ(renderer.pictureBytes(), 0u);
    }
}

// More cells take what more memory is predicted for.
TEST_F(MemoryTest, PropagationTakesWhatIsPredicted) {
    BRUME_WHOLE_LAYER_ONLY();
    const EyeRequest eye = eyeOf(64, 36);
    for (const bool coloured : {false, true}) {
        Scene scene = loadScene("server/scenes/cloud.toml");
        scene.render.method = "slabs", scene.render.rate = 4, scene.render.slabs = 16;
        scene.render.scattering = "propagation";
        scene.planes = {{.height = -20, .albedo = glm::vec3(0.5f)}};
        if (coloured) {
            scene.medium.albedo = {0.9f, 0.8f, 0.7f}, scene.medium.extinction_colour = {1, 0.5f, 0.2f};
            scene.medium.emission = glm::vec3(1);
            scene.render.propagation.onto_surfaces = true;
        }
        const Simulation simulation(scene);
        std::vector<gpu::Particle> particles(simulation.liveCount());
        simulation.write(particles);
        Renderer renderer(device(), scene, simulation.capacity());
        uint64_t predicted = 0, used = 0;
        for (const uint32_t cells : {8u, 22u, 64u}) { // 22: as 24
            scene.render.propagation.cells = cells;
            const uint64_t predicted_before = predicted, used_before = used;
            renderer.submit(submission_, simulation, {&eye, 1}, &scene.render);
            waitFor(submission_.commands);
            const auto hues = uint32_t(huesOf(simulation.now(), simulation.liveCount()).size());
            EXPECT_EQ(hues, coloured ? 3u : 1u);
            predicted = propagationMemory(tickOf(scene, particles), scene.render.propagation, true, hues);
            used = device().memoryInUse();
            if (used_before > 0) {
                EXPECT_NEAR(double(used - used_before), double(predicted - predicted_before), 64 << 10) << cells;
            }
        }
        EXPECT_GT(predicted, coloured ? 140u << 20 : 17u << 20);
    }
    Scene single = loadScene("server/scenes/cloud.toml");
    EXPECT_EQ(propagationMemory(tickOf(single, {}), single.render.propagation, true, 1), 0u);
}

// The same pictures again and again: nothing is allocated.
TEST_F(MemoryTest, PicturesOfTheSameSizesAllocateNothing) {
    const EyeRequest eyes[] = {eyeOf(160, 32), eyeOf(32, 160), eyeOf(96, 64)};
    draw(eyes);
    const uint64_t before = device().allocations();
    for (int i = 0; i < 5; ++i) draw(eyes);
    EXPECT_EQ(device().allocations(), before);
}

// Methods that were dropped leave their pipelines: to use one again compiles nothing, and what is kept is bounded.
TEST_F(MemoryTest, ALoopOverAFewSettingsCompilesNothingAgain) {
    const EyeRequest eye = eyeOf(32, 18);
    size_t after_first = 0;
    uint64_t resident = 0;
    const std::vector<std::string> names = methodNames(SceneFeatures());
    const size_t methods = names.size();
    for (size_t i = 0; i < 12 * methods; ++i) {
        settings_.method = names[i % methods];
        settings_.isv.quadrature = i / methods % 2 ? "simpson" : "analytic";
        draw({&eye, 1});
        if (i == 2 * methods - 1) after_first = device().pipelines().size(), resident = residentBytes();
    }
    EXPECT_GT(after_first, 5u);
    EXPECT_EQ(device().pipelines().size(), after_first);
    if (kSanitized) return; // it keeps what is freed for a while
    EXPECT_LE(residentBytes(), resident + (32 << 20));
}

TEST(IdleMemory, MemoryGoesBackAfterAMinuteWithLessThanHalfOfIt) {
    using std::chrono::seconds;
    IdleMemory room;
    const IdleMemory::time_point start{seconds(1000)};
    EXPECT_FALSE(room.spare(start)); // nothing was used
    room.use(100, start);
    room.use(49, start + seconds(30));
    EXPECT_FALSE(room.spare(start + seconds(59)));
    room.use(50, start + seconds(59)); // half of it: needed
    EXPECT_FALSE(room.spare(start + seconds(118)));
    EXPECT_TRUE(room.spare(start + seconds(119)));
    EXPECT_FALSE(room.spare(start + seconds(500))); // once
    room.use(49, start + seconds(500));
    for (int later = 501; later < 1000; ++later) { // a steady need keeps its memory
        room.use(49, start + seconds(later));
        EXPECT_FALSE(room.spare(start + seconds(later)));
    }
}

// Stands for a pipeline.
std::shared_ptr<const gpu::Pipeline> nothing() { return {std::make_shared<int>(0), nullptr}; }

TEST(PipelineCache, WhatNoProgramUsesIsBoundedAndTheOldestGoesFirst) {
    constexpr uint64_t kAll = 3 * gpu::PipelineCache::kMostUnused;
    gpu::PipelineCache cache;
    const auto used = nothing();
    cache.keep({0}, used);
    for (uint64_t i = 1; i < kAll; ++i) cache.keep({i}, nothing());
    EXPECT_EQ(cache.size(), 1 + gpu::PipelineCache::kMostUnused);
    EXPECT_EQ(cache.find({0}).get(), used.get());
    EXPECT_EQ(cache.find({1}).use_count(), 0);
    EXPECT_GT(cache.find({kAll - 1}).use_count(), 0);
}

// A way to render is made ready by a program that ends before the way is drawn with.
TEST(PipelineCache, NoNumberOfUsedPipelinesDropsThoseThatWaitForTheirUse) {
    gpu::PipelineCache cache;
    std::vector<std::shared_ptr<const gpu::Pipeline>> used;
    uint64_t key = 0;
    for (; key < 2 * gpu::PipelineCache::kMostUnused; ++key) cache.keep({key}, used.emplace_back(nothing()));
    const uint64_t waits = key;
    for (; key < waits + gpu::PipelineCache::kMostUnused; ++key) cache.keep({key}, nothing());
    EXPECT_GT(cache.find({waits}).use_count(), 0);
}

} // namespace
} // namespace brume::test::memory_test
