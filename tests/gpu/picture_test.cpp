// From radiance to planes and JPEG, several eyes in one submission, and what users get wrong.
#include <algorithm>
#include <cmath>
#include <sstream>

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <turbojpeg.h>

#include "server/encode/jpeg.h"
#include "tests/gpu/closed_form.h"

namespace brume::test::picture_test {
namespace {

// 0 ... 255, before rounding.
glm::dvec3 displayed(glm::dvec3 radiance, const RenderSettings& settings) {
    glm::dvec3 out;
    for (int c = 0; c < 3; ++c) {
        double x = std::max(radiance[c] * double(settings.exposure), 0.0);
        if (settings.tone_map == "filmic") x = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14); // Narkowicz 2015
        x = std::clamp(x, 0.0, 1.0);
        out[c] = 255 * (x > 0.0031308 ? 1.055 * std::pow(x, 1 / 2.4) - 0.055 : 12.92 * x);
    }
    return out;
}

// BT.601 as JFIF has it: full range, chroma around 128.
glm::dvec3 yCbCr(glm::dvec3 rgb) {
    const double y = 0.299 * rgb.r + 0.587 * rgb.g + 0.114 * rgb.b;
    return {y, 128 + (rgb.b - y) / 1.772, 128 + (rgb.r - y) / 1.402};
}

std::vector<uint8_t> bytesOf(const PictureView& picture) {
    return {picture.bytes, picture.bytes + picture.layout.bytes()};
}

class PictureTest : public GpuTest {
protected:
    // Every byte of the planes against the colours `at(x, y)`: within one level.
    template <class Colour>
    static void expectPlanes(const PictureView& picture, const Colour& at) {
        const PlaneLayout& layout = picture.layout;
        for (uint32_t y = 0; y < layout.height; ++y)
            for (uint32_t x = 0; x < layout.width; ++x)
                ASSERT_NEAR(picture.bytes[y * layout.lumaStride() + x], yCbCr(at(x, y)).x, 1) << x << ' ' << y;
        const uint8_t *cb = picture.bytes + layout.lumaBytes(), *cr = cb + layout.chromaBytes();
        for (uint32_t y = 0; y < layout.chromaHeight(); ++y)
            for (uint32_t x = 0; x < (layout.width + 1) / 2; ++x) {
                glm::dvec3 mean(0); // pixels beyond the edge repeat it
                for (uint32_t i = 0; i < 4; ++i)
                    mean += 0.25 * yCbCr(at(std::min(2 * x + i % 2, layout.width - 1),
                                            std::min(2 * y + i / 2, layout.height - 1)));
                ASSERT_NEAR(cb[y * layout.chromaStride() + x], mean.y, 1) << x << ' ' << y;
                ASSERT_NEAR(cr[y * layout.chromaStride() + x], mean.z, 1) << x << ' ' << y;
            }
    }

    static Scene cloudUnderSky() {
        Scene scene = loadScene("server/scenes/cloud.toml");
        scene.render.method = "sphere";
        scene.render.shadow_size = 64;
        return scene;
    }
};

TEST_F(PictureTest, PlanesOfAConstantSky) {
    for (const glm::vec3 sky : {glm::vec3(0), glm::vec3(1), glm::vec3(0.18f, 0.5f, 0.02f),
                                glm::vec3(1e-3f, 2e-3f, 4e-3f), glm::vec3(9, 0.1f, 0), glm::vec3(0, 0, 1e4f)}) {
        Scene scene = sceneOf({Point{{0, 0, 0}, 1, 0}});
        scene.sky = {sky, sky, glm::vec3(0)};
        Renderer renderer(device(), scene, 1);
        Submission submission(device(), "sky");
        for (const char* tone_map : {"linear", "filmic"})
            for (const float exposure : {0.4f, 1.0f, 3.0f}) {
                scene.render.tone_map = tone_map;
                scene.render.exposure = exposure;
                std::vector<EyeRequest> eyes;
                for (const auto& [width, height] : {std::pair(1u, 1u), std::pair(2u, 1u), std::pair(17u, 9u),
                                                    std::pair(33u, 31u), std::pair(16u, 16u)})
                    eyes.push_back({Pose{}, width, height});
                submitAndWait(renderer, submission, Simulation(scene), eyes);
                const auto pictures = submission.pictures();
                ASSERT_EQ(pictures.size(), eyes.size());
                for (const PictureView& picture : pictures) {
                    SCOPED_TRACE(testing::Message() << tone_map << " sky " << sky.r << ' ' << sky.g << ' ' << sky.b
                                                    << ", " << picture.layout.width);
                    expectPlanes(picture, [&](uint32_t, uint32_t) { return displayed(sky, scene.render); });
                }
            }
    }
}

TEST_F(PictureTest, PlanesOfACloud) {
    Scene scene = cloudUnderSky();
    Renderer renderer(device(), scene, 500);
    renderer.keepRadiance(true);
    Submission submission(device(), "cloud");
    for (const auto& [width, height] :
         {std::pair(1u, 1u), std::pair(17u, 9u), std::pair(33u, 31u), std::pair(90u, 64u)}) {
        SCOPED_TRACE(width);
        const EyeRequest eye{lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), width, height};
        submitAndWait(renderer, submission, Simulation(scene), {&eye, 1});
        const Picture radiance{width, height, renderer.readRadiance()};
        expectPlanes(submission.pictures()[0],
                     [&](uint32_t x, uint32_t y) { return displayed(glm::dvec4(radiance.at(x, y)), scene.render); });
    }
}

TEST_F(PictureTest, JpegGivesTheColoursBack) {
    Scene scene = cloudUnderSky();
    Renderer renderer(device(), scene, 500);
    renderer.keepRadiance(true);
    Submission submission(device(), "jpeg");
    for (const auto& [width, height] : {std::pair(1u, 1u), std::pair(17u, 9u), std::pair(160u, 90u)}) {
        const EyeRequest eye{lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), width, height};
        submitAndWait(renderer, submission, Simulation(scene), {&eye, 1});
        const Picture radiance{width, height, renderer.readRadiance()};
        const std::vector<uint8_t> jpeg = JpegEncoder().encode(submission.pictures()[0], 95);
        const std::unique_ptr<void, int (*)(void*)> decoder(tjInitDecompress(), tjDestroy);
        int got_width = 0, got_height = 0, subsampling = 0, colours = 0;
        ASSERT_EQ(tjDecompressHeader3(decoder.get(), jpeg.data(), static_cast<unsigned long>(jpeg.size()), &got_width,
                                      &got_height, &subsampling, &colours),
                  0);
        ASSERT_EQ(got_width, int(width));
        ASSERT_EQ(got_height, int(height));
        EXPECT_EQ(subsampling, TJSAMP_420);
        std::vector<uint8_t> rgb(size_t(width) * height * 3);
        ASSERT_EQ(tjDecompress2(decoder.get(), jpeg.data(), static_cast<unsigned long>(jpeg.size()), rgb.data(),
                                got_width, 0, got_height, TJPF_RGB, 0),
                  0);
        double squares = 0, worst = 0;
        for (size_t i = 0; i < radiance.pixels.size(); ++i) {
            const glm::dvec3 expected = displayed(glm::dvec4(radiance.pixels[i]), scene.render);
            const glm::dvec3 got(rgb[3 * i], rgb[3 * i + 1], rgb[3 * i + 2]);
            squares += glm::dot(got - expected, got - expected) / 3;
            worst = std::max(worst, std::abs(yCbCr(got).x - yCbCr(expected).x));
        }
        // Quality 95 quantises brightness in steps of 2 to 12 levels; colour has a quarter of the pixels, which the
        // smallest picture's few steep ones show.
        EXPECT_LT(worst, width < 100 ? 8 : 4) << width;
        EXPECT_LT(std::sqrt(squares / double(radiance.pixels.size())), width < 100 ? 6 : 1.5) << width;
    }
}

// --- several eyes ---

class EyesTest : public PictureTest {
protected:
    static std::vector<EyeRequest> eyes() {
        return {{lookAt({0, 2, 26}, {0, 0, 0}, 0.8f), 90, 64},
                {lookAt({1, 0, 2}, {0, 0, 0}, 1.2f), 33, 31},
                {lookAt({20, 3, 5}, {0, 0, 0}, 0.6f), 64, 48},
                {lookAt({-9, -6, 3}, {0, 1, 0}, 1), 120, 20},
                {lookAt({0, 40, 0}, {0, 0, 0}, 0.4f), 1, 1}};
    }
};

TEST_F(EyesTest, ThePictureDoesNotDependOnTheCompany) {
    struct Case {
        const char *scene, *method;
        uint32_t rate; // of rays: passes of eyes with the same one run together, but where objects are
    };
    for (const auto& [name, method, rate] :
         {Case{"props", "sphere", 0}, Case{"props", "isv", 0}, Case{"props", "slabs", 4}, Case{"cloud", "slabs", 0},
          Case{"cloud", "slabs", 16}, Case{"cloud", "slabs", 1}, Case{"cloud", "grid", 8}}) {
        SCOPED_TRACE(testing::Message() << name << ' ' << rate);
        Scene scene = loadScene("server/scenes/" + std::string(name) + ".toml");
        scene.render.method = method;
        scene.render.rate = rate;
        scene.render.shadow_size = 64;
        const Simulation simulation(scene);
        const auto planesOf = [&](Renderer& renderer, const std::vector<EyeRequest>& wanted) {
            Submission submission(device(), "eyes");
            submitAndWait(renderer, submission, simulation, wanted);
            std::vector<std::vector<uint8_t>> planes;
            for (const PictureView& picture : submission.pictures()) planes.push_back(bytesOf(picture));
            return planes;
        };
        Renderer renderer(device(), scene, simulation.capacity());
        std::vector<std::vector<uint8_t>> alone;
        for (const EyeRequest& eye : eyes())
            alone.push_back(planesOf(renderer, {eye})[0]); // its targets grow as they go
        EXPECT_EQ(planesOf(renderer, eyes()), alone) << method;
        EXPECT_EQ(planesOf(renderer, eyes()), alone) << method << ", again";
        std::vector<EyeRequest> backwards = eyes();
        std::reverse(backwards.begin(), backwards.end());
        std::reverse(alone.begin(), alone.end());
        EXPECT_EQ(planesOf(renderer, backwards), alone) << method << ", backwards";
        Renderer fresh(device(), scene, simulation.capacity());
        EXPECT_EQ(planesOf(fresh, backwards), alone) << method << ", another renderer";
    }
}

// Eyes whose passes run together are as many as their buffers hold: more than one group, none of which may see
// another's rest.
TEST_F(EyesTest, SixtyFourTogetherSeeWhatOneSees) {
    Scene scene = loadScene("server/scenes/cloud.toml");
    scene.render.method = "slabs";
    scene.render.rate = 4;
    scene.render.slabs = 256;
    scene.render.shadow_size = 64;
    const Simulation simulation(scene);
    Renderer renderer(device(), scene, simulation.capacity());
    Submission submission(device(), "eyes");
    std::vector<EyeRequest> many;
    for (int i = 0; i < 64; ++i)
        many.push_back({lookAt({26 * std::sin(0.1f * float(i)), 2, 26}, {0, 0, 0}, 0.8f), 320, 180});
    submitAndWait(renderer, submission, simulation, many);
    std::vector<std::vector<uint8_t>> together;
    for (const PictureView& picture : submission.pictures()) together.push_back(bytesOf(picture));
    for (const size_t i : {0u, 31u, 50u, 63u}) {
        submitAndWait(renderer, submission, simulation, {&many[i], 1});
        EXPECT_EQ(bytesOf(submission.pictures()[0]), together[i]) << i;
    }
}

TEST_F(EyesTest, RadianceHasTheSameBitsOnEveryRun) {
    for (const char* method : {"sphere", "isv"}) {
        Scene scene = cloudUnderSky();
        scene.render.method = method;
        const Pose pose = lookAt({4, 2, 9}, {0, 0, 0}, 1);
        const Picture first = plain().see(scene, pose, 90, 64);
        EXPECT_TRUE(first.pixels == plain().see(scene, pose, 90, 64).pixels) << method;
        EXPECT_TRUE(first.pixels == Stage(device(), sceneOf({Point{}}), 500).see(scene, pose, 90, 64).pixels) << method;
    }
}

// --- what rests ---

// Particles are uploaded and the light is made when they change, and then the picture is that of a renderer that has
// seen nothing before.
TEST_F(PictureTest, WhatRestsIsNotLitAgain) {
    Scene scene = loadScene("server/scenes/props.toml");
    scene.render.method = "sphere";
    scene.medium.count = 200;
    scene.simulation.paused = true;
    Simulation simulation(scene);
    Renderer renderer(device(), scene, 200);
    Submission submission(device(), "rest");
    const EyeRequest eye{lookAt(scene.camera.position, scene.camera.target, 0.8f), 64, 48};
    const auto passes = [&](const char* what) {
        submitAndWait(renderer, submission, simulation, {&eye, 1});
        const auto seen = bytesOf(submission.pictures()[0]);
        Renderer fresh(device(), scene, 200);
        Submission other(device(), "fresh");
        submitAndWait(fresh, other, simulation, {&eye, 1});
        EXPECT_EQ(seen, bytesOf(other.pictures()[0])) << what;
        std::string names;
        for (const gpu::PassSample& sample : submission.commands.readTimes())
            if (sample.view == gpu::kShared && sample.name != std::string_view("read back"))
                names += sample.name + std::string(";");
        return names;
    };
    const auto after = [&](const CommandBody& body) {
        const Command command{.body = body};
        simulation.step({&command, 1});
    };
    EXPECT_EQ(passes("at first"), "upload;opaque shadow;shadow volume;");
    EXPECT_EQ(passes("again"), "");
    simulation.step({});
    EXPECT_EQ(passes("a paused tick later"), "");
    after(Set{{"light.to_light", glm::vec3(0.5f, 1, 0.2f)}});
    EXPECT_EQ(passes("the light has turned"), "opaque shadow;shadow volume;");
    after(Set{{"light.irradiance", glm::vec3(3, 4, 5)}});
    EXPECT_EQ(passes("it is brighter"), "");
    after(Set{{"medium.asymmetry", 0.3f}});
    EXPECT_EQ(passes("the medium scatters otherwise"), "");
    after(Set{{"medium.falloff", 2.0f}});
    EXPECT_EQ(passes("particles are wider"), "shadow volume;");
    after(Set{{"medium.albedo", glm::vec3(0.2f)}});
    EXPECT_EQ(passes("they are darker"), "upload;shadow volume;");
    after(Set{{"render.exposure", 2.0f}});
    EXPECT_EQ(passes("exposure"), "");
    after(Set{{"simulation.paused", false}});
    after(Impulse{.origin = {-5, 7, 27}, .direction = glm::normalize(glm::vec3(5, -2, -27))});
    EXPECT_EQ(passes("they move"), "upload;shadow volume;");
}

// --- the ends of what a scene may be ---

// 0 is an allowed cut-off: it means that nothing that could be seen is left out.
TEST_F(PictureTest, NoCutOffAtAll) {
    Scene scene = sceneOf({Point{{0, 0, 0}, 2, 0.5f}}, 1.6f);
    const Pose pose = lookAt({1, 2, 7}, {0, 0, 0}, 0.7f);
    for (const char* method : {"sphere", "isv"}) {
        scene.render.method = method;
        scene.render.cutoff = 1e-6f;
        const Picture some = plain().see(scene, pose, 64, 48);
        scene.render.cutoff = 0;
        const Picture none = plain().see(scene, pose, 64, 48);
        for (size_t i = 0; i < some.pixels.size(); ++i)
            for (int c = 0; c < 4; ++c)
                ASSERT_NEAR(none.pixels[i][c], some.pixels[i][c], 2e-4f) << method << ' ' << i; // coarser shadow texels
    }
}

// --- errors ---

TEST_F(PictureTest, AnUnknownDeviceIsAnswersWithThoseThatThereAre) {
    gpu::DeviceOptions options;
    options.name = "no such device";
    try {
        const gpu::Device none(options);
        FAIL() << "made a device of the name 'no such device'";
    } catch (const gpu::Error& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("no such device"), std::string::npos) << text;
        EXPECT_NE(text.find(device().name()), std::string::npos) << text;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
}

TEST_F(PictureTest, SettingsAreChecked) {
    RenderSettings settings;
    const auto says = [&](const char* what) {
        EXPECT_NE(checkSettings(settings).find(what), std::string::npos) << checkSettings(settings);
    };
    says("'auto'"); // the plan's to resolve
    settings.method = "sphere";
    EXPECT_EQ(checkSettings(settings), "");
    settings.method = "raymarch";
    says("'raymarch'");
    for (const std::string& method : methodNames()) says(method.c_str());
    EXPECT_THROW(plain().see(
                     [&] {
                         Scene scene = sceneOf({Point{}});
                         scene.render = settings;
                         return scene;
                     }(),
                     Pose{}, 8, 8),
                 gpu::Error);
    for (const std::string& method : methodNames()) {
        settings.method = method;
        EXPECT_EQ(checkSettings(settings), "");
    }
    settings.merge = -1;
    says("merge must be 0 ... 8");
    settings.merge = 0;
    settings.isv.quadrature = "gauss";
    says("'gauss'");
    for (const char* name : {"simpson", "transmittance", "analytic", "taylor"}) says(name);
    settings.isv.quadrature = "simpson";
    settings.tiles.quadrature = "simpson";
    says("there are: cached, hermite");
    settings.tiles.quadrature = "cached";
    const struct {
        const char *quadrature, *range;
        uint32_t bad[2];
    } cases[] = {{"simpson", "1 ... 10", {0, 11}}, {"transmittance", "1 ... 3", {0, 4}}};
    for (const auto& one : cases)
        for (const uint32_t steps : one.bad) {
            settings.isv = {one.quadrature, steps};
            says(one.range);
        }
}

// What a device's objects leave behind is reported when it goes.
TEST(Device, EverythingIsGivenBack) {
    std::ostringstream log;
    const auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(log);
    spdlog::default_logger()->sinks().push_back(sink);
    {
        gpu::DeviceOptions options;
        options.validation = true;
        const gpu::Device device(options);
        for (const char* method : {"sphere", "isv"}) {
            Scene scene = sceneOf({Point{}, Point{{1, 0, 0}}});
            scene.render.method = method;
            scene.boxes = {Box{}};
            render(device, scene, Pose{}, 20, 10);
        }
    }
    spdlog::default_logger()->sinks().pop_back();
    EXPECT_EQ(log.str(), "");
}

} // namespace
} // namespace brume::test::picture_test
