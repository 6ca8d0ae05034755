// The frame loop with a real device and no network: from poses to encoded frames, and what happens to a picture that
// cannot be.
#include "server/frame/frame_loop.h"
#include "server/gpu/pipeline_cache.h"
#include "tests/gpu/fixture.h"
#include "tests/gpu/quadrature.h"
#include "tests/layer.h"
#include "tools/bench/looker.h"

namespace brume::test::frame_loop_test {
namespace {

// A viewer who looks on, past the same point.
class Looker : public bench::Looker {
public:
    using bench::Looker::Looker;
    void look(uint32_t seq, float x) { lookFrom(seq, {x, 2, 26}); }
    void lookFrom(uint32_t seq, glm::vec3 position, bool once = false) {
        bench::Looker::look(seq, lookAt(position, {0.5f, 0, 0}, 0.8f), once);
    }
};

// Ticks as the test gives them.
class GivenTicks final : public TickSource {
public:
    explicit GivenTicks(std::atomic<int>& left) : left_(left) {}
    Clock::time_point due() const override {
        return Clock::now() + (left_ > 0 ? std::chrono::seconds(0) : std::chrono::seconds(1));
    }
    bool take(Clock::time_point, std::vector<Command>& commands) override {
        commands.clear();
        if (left_ <= 0) return false;
        --left_;
        return true;
    }

private:
    std::atomic<int>& left_;
};

// Ticks that are long due, but for each second look.
class OverdueTicks final : public TickSource {
public:
    explicit OverdueTicks(std::atomic<int>& taken) : taken_(taken) {}
    Clock::time_point due() const override { return Clock::time_point::min(); }
    bool take(Clock::time_point, std::vector<Command>& commands) override {
        commands.clear();
        there_ = !there_;
        taken_ += there_;
        return there_;
    }

private:
    std::atomic<int>& taken_;
    bool there_ = false;
};

class FrameLoopTest : public GpuTest {
protected:
    Scene scene_ = loadScene("server/scenes/cloud.toml");
    Audience audience_{{}, sceneFacts(scene_), 8, 4};
    Metrics metrics_;
    std::atomic<bool> failed_{false};
};

TEST_F(FrameLoopTest, APoseIsAnsweredByAPictureOfItsTick) {
    std::atomic<int> ticks{0};
    FrameLoop loop(scene_, device(), audience_, metrics_, {});
    loop.start([&] { failed_ = true; }, std::make_unique<GivenTicks>(ticks));
    Looker looker(audience_, 64, 36);
    looker.look(1, 0);
    ticks = 3;
    const FramePtr frame = looker.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->request.seq, 1u);
    EXPECT_GE(frame->tick, 1u);
    EXPECT_LE(frame->tick, 3u);
    ASSERT_GE(frame->jpeg[0]->size(), 4u);
    EXPECT_EQ((*frame->jpeg[0])[0], 0xff); // a JPEG begins so
    EXPECT_EQ((*frame->jpeg[0])[1], 0xd8);
    loop.stop();
    EXPECT_FALSE(failed_);
}

TEST_F(FrameLoopTest, WaitsForNothingWhileATickIsDue) {
    std::atomic<int> taken{0};
    FrameLoop loop(scene_, device(), audience_, metrics_, {});
    loop.start([&] { failed_ = true; }, std::make_unique<OverdueTicks>(taken));
    const auto deadline = Clock::now() + std::chrono::seconds(10);
    while (taken < 100 && Clock::now() < deadline) std::this_thread::yield();
    loop.stop();
    EXPECT_GE(taken, 100) << "in ten seconds; one a second is the wait for the next report";
    EXPECT_FALSE(failed_);
}

// 16383 x 16383 pixels are 384 MiB of planes; no device that we know lets a shader see so much of a buffer... at once.
TEST_F(FrameLoopTest, APictureThatCannotBeCostsItsViewerThePlaceAndNobodyElse) {
    if (Renderer::mostPictureBytes(device()) >= 16383ull * 16383 * 3 / 2)
        GTEST_SKIP() << "this device draws pictures of 16383 x 16383";
    FrameLoop::Options options;
    options.most_frame_ms = 1e9; // nothing is made smaller for want of time
    FrameLoop loop(scene_, device(), audience_, metrics_, options);
    loop.start([&] { failed_ = true; });
    Looker modest(audience_, 64, 36), greedy(audience_, 16383, 16383);
    modest.look(1, 0);
    ASSERT_TRUE(modest.next());
    greedy.look(1, 0);
    EXPECT_FALSE(greedy.next());
    EXPECT_NE(greedy.refusal().find("ask for smaller"), std::string::npos) << greedy.refusal();
    for (uint32_t seq = 2; seq < 5; ++seq) {
        modest.look(seq, float(seq));
        FramePtr frame = modest.next();
        while (frame && frame->request.seq < seq) frame = modest.next();
        ASSERT_TRUE(frame) << seq;
    }
    EXPECT_EQ(modest.refusal(), "");
    loop.stop();
    EXPECT_FALSE(failed_);
}

// A picture that fits without lamps does not with them.
TEST_F(FrameLoopTest, LightThatIsKeptForEachPixelCountsAsPictureMemory) {
    FrameLoop::Options options;
    options.picture_memory = 2 * 35 * 320 * 180; // half of it for the target: 35 bytes a pixel
    for (const char* file : {"server/scenes/cloud.toml", "server/scenes/stage.toml"}) {
        Scene scene = loadScene(file);
        const bool lit = scene.name == "stage";
        Audience audience{{}, sceneFacts(scene), 8, 4};
        FrameLoop loop(std::move(scene), device(), audience, metrics_, options);
        loop.start([&] { failed_ = true; });
        Looker looker(audience, 320, 180);
        looker.look(1, 0);
        EXPECT_EQ(looker.next() == nullptr, lit) << file;
        EXPECT_EQ(looker.refusal().find("ask for smaller") != std::string::npos, lit) << looker.refusal();
        loop.stop();
    }
    EXPECT_FALSE(failed_);
}

FrameLoop::NextScene nextScene(const char* file, const std::vector<std::string>& settings = {}) {
    const Scene scene = loadScene(file, settings);
    return {scene, Simulation(scene), {"another"}, {}};
}

TEST_F(FrameLoopTest, AnotherSceneIsShownToWhoLooksOn) {
    FrameLoop loop(scene_, device(), audience_, metrics_, {});
    loop.start([&] { failed_ = true; });
    Looker looker(audience_, 64, 36);
    looker.look(1, 0);
    const FramePtr before = looker.next();
    ASSERT_TRUE(before);
    FrameLoop::NextScene next = nextScene("server/scenes/props.toml");
    uint64_t first_tick = 0, first_state = 0;
    next.on_show = [&](const Simulation& simulation) {
        first_tick = simulation.tick();
        first_state = simulation.stateHash();
    };
    loop.replaceScene(std::move(next)).get();
    EXPECT_EQ(audience_.scene()->scene.name, "props");
    EXPECT_EQ(audience_.scene()->others, std::vector<std::string>{"another"});
    EXPECT_GT(first_tick, before->tick);
    EXPECT_EQ(first_state, Simulation(loadScene("server/scenes/props.toml")).stateHash());
    FramePtr after = looker.next();
    while (after && after->tick <= first_tick) after = looker.next();
    ASSERT_TRUE(after);
    Simulation same(loadScene("server/scenes/props.toml"));
    for (uint64_t tick = first_tick; tick < after->tick; ++tick) same.step({});
    EXPECT_EQ(after->state_hash, same.stateHash());
    loop.stop();
    EXPECT_FALSE(failed_);
}

// Shows a scene that fails with Error. Who looks on sees the old one from another place.
template <class Error>
void expectOldScene(FrameLoop& loop, Audience& audience, FrameLoop::NextScene next) {
    loop.start([] { FAIL() << "the loop ended"; });
    Looker looker(audience, 64, 36);
    looker.look(1, 0);
    ASSERT_TRUE(looker.next());
    EXPECT_THROW(loop.replaceScene(std::move(next)).get(), Error);
    EXPECT_EQ(audience.scene()->scene.name, "cloud");
    looker.look(2, 1);
    FramePtr frame = looker.next();
    while (frame && frame->request.seq < 2) frame = looker.next();
    EXPECT_TRUE(frame);
    loop.stop();
}

TEST_F(FrameLoopTest, ASceneThatDoesNotFitLeavesTheOldOne) {
    FrameLoop::Options options;
    options.memory = 1 << 20;
    FrameLoop loop(scene_, device(), audience_, metrics_, options);
    expectOldScene<SceneError>(loop, audience_, nextScene("server/scenes/cloud.toml", {"medium.count=50000"}));
}

TEST_F(FrameLoopTest, ASceneForWhichMemoryEndsLeavesTheOldOne) {
    FrameLoop loop(scene_, device(), audience_, metrics_, {});
    FrameLoop::NextScene next = nextScene("server/scenes/props.toml");
    next.on_show = [](const Simulation&) { throw std::bad_alloc(); };
    expectOldScene<std::bad_alloc>(loop, audience_, std::move(next));
}

// A viewer's frame of its newest pose.
FramePtr frameOf(Looker& looker, uint32_t seq) {
    FramePtr frame = looker.next();
    while (frame && frame->request.seq < seq) frame = looker.next();
    return frame;
}

// A device of its own has no pipelines of other tests: those that it gets are those that somebody has to wait for.
TEST_F(FrameLoopTest, NoCameraMakesOthersWaitForAShader) {
    const gpu::Device fresh{gpu::DeviceOptions{}};
    FrameLoop::Options options;
    options.compiled_behind = true;
    FrameLoop loop(scene_, fresh, audience_, metrics_, options);
    CompiledWays& ways = loop.compiledWays();
    std::atomic<int> wanted{0};
    ways.serve([&] { ++wanted; });
    loop.start([&] { failed_ = true; });
    Looker steady(audience_, 640, 360), jumper(audience_, 640, 360), snapshot(audience_, 320, 180);
    uint32_t seq = 1;
    const size_t pipelines = fresh.pipelines().size();
    for (const glm::vec3 place : {glm::vec3(0, 2, 26), {0, 3, 2}, {0, 2, 60}, {0.5, 3, 4.9}, {0, 2, 400}}) {
        ++seq;
        steady.look(seq, float(seq));
        jumper.lookFrom(seq, place);
        ASSERT_TRUE(frameOf(jumper, seq));
        ASSERT_TRUE(frameOf(steady, seq));
        EXPECT_EQ(fresh.pipelines().size(), pipelines) << place.z;
    }
    EXPECT_GT(wanted, 0);
    // A snapshot waits for its shaders, and is drawn when they are there.
    snapshot.lookFrom(1, {0, 2, 60}, true);
    for (int i = 0; i < 10; ++i) {
        ++seq;
        steady.look(seq, float(seq));
        ASSERT_TRUE(frameOf(steady, seq));
    }
    EXPECT_EQ(fresh.pipelines().size(), pipelines);
    while (const auto next = ways.nextWanted()) ways.add(next->shaders);
    ASSERT_TRUE(snapshot.next());
    EXPECT_GT(fresh.pipelines().size(), pipelines) << "or it shows nothing";
    loop.stop();
    EXPECT_FALSE(failed_);
}

// What needs other shaders is drawn once they are compiled: light that scatters more often, another method, other
// shadows, a lobe, the first sunlight.
TEST_F(FrameLoopTest, NoSettingMakesOthersWaitForAShader) {
    using Text = std::string;
    scene_.medium.phase = kMixturePhase, scene_.medium.anisotropy = 0;
    for (Light& light : scene_.lights) light.irradiance = glm::vec3(0);
    scene_.boxes = {{}};
    FrameLoop::Options options;
    options.compiled_behind = true;
    options.most_frame_ms = 6e4;
    for (const auto& [method, change] : {std::pair("slabs", Change("render.scattering", Text("octaves"))),
                                         {"slabs", {"render.method", Text("froxels")}},
                                         {"froxels", {"render.froxels.shadows", Text("grid")}},
                                         {"slabs", {"medium.anisotropy", 0.5f}},
                                         {"slabs", {"light.irradiance", glm::vec3(3)}}}) {
        scene_.render.method = method;
        const gpu::Device fresh{gpu::DeviceOptions{}};
        FrameLoop loop(scene_, fresh, audience_, metrics_, options);
        CompiledWays& ways = loop.compiledWays();
        loop.start([&] { failed_ = true; });
        Looker steady(audience_, 64, 36);
        uint32_t seq = 0;
        const auto look = [&] {
            ++seq;
            steady.look(seq, float(seq % 8));
            return frameOf(steady, seq) != nullptr;
        };
        const size_t pipelines = fresh.pipelines().size();
        const uint64_t version = audience_.report()->settings_version;
        ASSERT_TRUE(audience_.commands().push({1, 1, Set{change}}));
        while (audience_.report()->settings_version == version) ASSERT_TRUE(look());
        for (int i = 0; i < 6; ++i) ASSERT_TRUE(look());
        EXPECT_EQ(fresh.pipelines().size(), pipelines) << change.path();
        if (const auto features = ways.wantedFeatures()) ways.add(*features, {});
        while (const auto next = ways.nextWanted()) ways.add(next->shaders);
        const auto deadline = Clock::now() + std::chrono::seconds(30);
        while (fresh.pipelines().size() == pipelines && Clock::now() < deadline) ASSERT_TRUE(look());
        EXPECT_GT(fresh.pipelines().size(), pipelines) << change.path() << ": or it shows nothing";
        loop.stop();
    }
    EXPECT_FALSE(failed_);
}

// A viewer may be welcomed before the first tick.
TEST_F(FrameLoopTest, TheScenesOwnSettingsAreToldBeforeTheFirstTick) {
    scene_.simulation.paused = true;
    scene_.render.exposure = 0.25f;
    const FrameLoop loop(scene_, device(), audience_, metrics_, {});
    const auto values = audience_.report()->settings;
    for (size_t i = 0; i < values.size(); ++i) {
        if (liveSettings()[i]->path == "simulation.paused") {
            EXPECT_EQ(values[i], SettingValue(true));
        }
        if (liveSettings()[i]->path == "render.exposure") {
            EXPECT_EQ(values[i], SettingValue(0.25f));
        }
    }
}

// A hundred changes of what is rendered with: two methods stay on the device, not a hundred.
TEST_F(FrameLoopTest, MethodsThatAreNoLongerUsedAreGone) {
    Simulation simulation(scene_);
    Renderer renderer(device(), scene_, simulation.capacity());
    Submission submission(device(), "methods");
    const EyeRequest eye{lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), 32, 18};
    uint64_t most_of_first = 0, most_later = 0; // bytes; the first: while every method is used twice
    const std::vector<std::string> names = methodNames(SceneFeatures());
    for (int i = 0; i < 40; ++i) {
        RenderSettings settings = scene_.render;
        settings.method = names[size_t(i) % names.size()];
        for (const SceneSetting* setting : liveSettings())
            if (setting->key() == "quadrature")
                setQuadrature(settings, std::string(setting->choices[size_t(i / 5) % setting->choices.size()]));
        settings.isv.steps = uint32_t(i % 3 + 1);
        renderer.submit(submission, simulation, {&eye, 1}, &settings);
        waitFor(submission.commands);
        EXPECT_LE(renderer.methodsKept(), 2u);
        uint64_t& most = i < int(2 * names.size()) ? most_of_first : most_later;
        most = std::max(most, device().memoryInUse());
    }
    EXPECT_LE(most_later, most_of_first + most_of_first / 4);
}

// A picture at rest is drawn again for who looks at errors, but not where nothing can be measured.
TEST_F(FrameLoopTest, ErrorsAreCollectedWhereTheyCanBeMeasured) {
    scene_.simulation.paused = true;
    const auto collects = [&](const char* scattering, glm::vec3 target) {
        scene_.render.scattering = scattering;
        FrameLoop::Options options;
        options.measure_error = 1;
        options.frame_ms = 1e4, options.most_frame_ms = 6e4; // nothing is given up
        FrameLoop loop(scene_, device(), audience_, metrics_, options);
        loop.start([&] { failed_ = true; });
        const std::shared_ptr<Viewer> viewer = audience_.join([] {}).viewer;
        PoseRequest request{.seq = 1, .pose = lookAt({0.1f, 2, 26}, target, 0.8f), .width = 64, .height = 36};
        request.show = gpu::kShowError;
        request.received = Clock::now();
        viewer->setPose(request);
        int stills = 0; // a second one is there because errors are collected
        Clock::time_point last = Clock::now();
        while (stills < 3 && Clock::now() - last < std::chrono::seconds(stills == 0 ? 30 : 2)) {
            if (const FramePtr frame = viewer->takeFrame()) {
                viewer->acknowledge(frame->id);
                stills += frame->request.still_picture;
                last = Clock::now();
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        audience_.leave(viewer);
        EXPECT_GE(stills, 1);
        return stills > 1;
    };
    const glm::vec3 there(0.5f, 0, 0), away(0, 0, 100);
    EXPECT_TRUE(collects("single", there));
    EXPECT_FALSE(collects("octaves", there));
    EXPECT_FALSE(collects("single", away));
    EXPECT_FALSE(failed_);
}

// The laws predict a tenth of the error: what is measured mends the plan.
TEST_F(FrameLoopTest, ALawThatIsWrongIsMendedByMeasuring) {
    BRUME_WHOLE_LAYER_ONLY();
    FrameLoop::Options options;
    options.measure_error = 1;
    options.law_factor = 0.1;
    FrameLoop loop(scene_, device(), audience_, metrics_, options);
    loop.start([&] { failed_ = true; });
    Looker looker(audience_, 160, 90);
    double worst = 0, last = 1;
    const auto end = Clock::now() + std::chrono::seconds(60);
    for (uint32_t seq = 1; Clock::now() < end && (worst <= 0.005 || last > 0.005); ++seq) {
        looker.look(seq, 1e-3f * float(seq));
        ASSERT_TRUE(looker.next());
        for (const ViewError& one : audience_.report()->errors) {
            if (!one.newest.known()) continue;
            last = one.newest.rmse;
            worst = std::max(worst, last);
        }
    }
    EXPECT_GT(worst, 0.005) << "the promise was never broken";
    EXPECT_LE(last, 0.005);
    EXPECT_LE(audience_.report()->plan.error, 0.006) << "as corrected";
    loop.stop();
    EXPECT_FALSE(failed_);
}

} // namespace
} // namespace brume::test::frame_loop_test
