// The native client draws what the server would draw of the same rounded particles, bit for bit.
#include "client/native/drawn_scene.h"
#include "client/native/lit_reader.h"
#include "server/encode/rgb.h"
#include "server/frame/lit_rows.h"
#include "server/methods/plans.h"
#include "server/net/outgoing.h"
#include "server/plan/planner.h"
#include "tests/gpu/fixture.h"

namespace brume::test::drawn_scene_test {
namespace {

// A message of the scene as it is now, as a viewer reads it.
struct Message {
    std::vector<uint8_t> header;
    wire::Parsed parsed;
    lit::Rows rows;
    const wire::LitParticles& lit() const { return *parsed.as<wire::LitParticles>(); }
};

Message messageOf(const gpu::Device& device, const Scene& scene, const Simulation& simulation) {
    Renderer renderer(device, scene, simulation.capacity());
    Submission submission(device, "light");
    renderer.submitLight(submission, simulation, scene.render);
    waitFor(submission.commands);
    const Submission::Fits& fits = submission.fits();
    LitRows made = litRows(fits, 0);
    auto lit = std::make_shared<LitTick>();
    lit->number = 1;
    lit->count = made.rows.count;
    lit->origin = made.origin, lit->step = made.step;
    lit->scene = fits.tick;
    lit->objects = fits.objects;
    for (const Hue& hue : fits.hues) lit->hues.push_back({uint8_t(hue.channels), hue.particles});
    lit->changes = lit::Packer().pack(made.rows, nullptr);
    lit->exposure = scene.render.exposure;
    EncodedFrame frame;
    frame.lit = lit;
    const wire::Packed packed = net::packLitHeader(frame, 0);
    Message message{{packed.data(), packed.data() + packed.size()}, {}, {}};
    message.header.insert(message.header.end(), lit->changes.bytes.begin(), lit->changes.bytes.end());
    message.parsed = *wire::parse(message.header);
    client::LitReader reader;
    if (const lit::Rows* rows = reader.read(message.lit(), message.parsed.jpeg)) message.rows = *rows;
    return message;
}

// The scene with the particles that the message rounded, as the server draws it.
std::vector<uint8_t> drawnByServer(const gpu::Device& device, Scene scene, const Message& message, const Pose& pose,
                                   glm::uvec2 size) {
    scene.medium.layout = Layout::live;
    scene.medium.count = std::bit_ceil(message.rows.count);
    Simulation simulation(scene);
    auto rows = std::make_shared<ParticleRows>();
    const wire::Vec3& origin = *message.lit().origin();
    for (uint32_t i = 0; i < message.rows.count; ++i) {
        const auto each = [&](uint32_t column) {
            return glm::vec3(message.rows.columns[column][i], message.rows.columns[column + 1][i],
                             message.rows.columns[column + 2][i]);
        };
        rows->positions.push_back(glm::vec3(origin.x(), origin.y(), origin.z()) +
                                  message.lit().step() * each(lit::kPlace));
        rows->scales.push_back(lit::ofLogCode(message.rows.columns[lit::kScale][i]));
        rows->extinctions.push_back(lit::ofLogCode(message.rows.columns[lit::kExtinction][i]));
        rows->albedos.push_back(each(lit::kAlbedo) / 65535.0f);
    }
    const Command set{.body = SetParticles{0, message.rows.count, 0, rows}};
    simulation.step({&set, 1});
    PlanInputs inputs{.scene = planScene(scene, simulation), .methods = allMethods()};
    inputs.views = {{pose, size.x, size.y}};
    const RenderSettings settings = makePlan(inputs, builtInCosts()).chosen.settings;
    Renderer renderer(device, scene, simulation.capacity());
    Submission submission(device, "server");
    const EyeRequest eye{pose, size.x, size.y};
    renderer.submit(submission, simulation, {&eye, 1}, &settings, true);
    waitFor(submission.commands);
    std::vector<uint8_t> rgb;
    packRgb(submission.pictures().front(), rgb);
    return rgb;
}

Scene sceneWithAll() {
    Scene scene;
    scene.medium.count = 300;
    scene.medium.extent = 6;
    scene.medium.scale = {3, 5};
    scene.medium.extinction = 60;
    scene.medium.albedo = {0.9f, 0.8f, 0.7f};
    scene.medium.anisotropy = 0.6f, scene.medium.asymmetry = 0.5f;
    scene.lights = {Light{}};
    scene.sky.ambient = {0.1f, 0.2f, 0.3f};
    scene.sky.zenith = {0.1f, 0.2f, 0.5f};
    scene.sky.haze = 0.01f;
    scene.planes.push_back({-4, {0.3f, 0.25f, 0.2f}, 0.5f, 3});
    scene.boxes.push_back({{2, 0, 2}, {1, 2, 1}, 0, {0.5f, 0.1f, 0.1f}});
    scene.spheres.push_back({{-2, 1, 1}, 0.8f, {0.1f, 0.5f, 0.1f}});
    return scene;
}

TEST_F(GpuTest, DrawnScenesAreTheServersBitForBit) {
    constexpr glm::uvec2 kSize{96, 54};
    const Pose pose = lookAt({3, 2, 14}, {0, 0, 0}, 0.7f);
    client::DrawnScene drawn;
    client::Picture picture;
    for (const bool coloured : {false, true}) {
        Scene scene = sceneWithAll();
        if (coloured) scene.medium.extinction_colour = {0.5f, 0.5f, 1};
        Simulation simulation(scene);
        const Message message = messageOf(device(), scene, simulation);
        ASSERT_EQ(message.rows.count, 300u);
        drawn.take(message.lit(), message.rows);
        drawn.draw(pose, kSize.x, kSize.y, picture);
        const std::vector<uint8_t> server = drawnByServer(device(), scene, message, pose, kSize);
        ASSERT_EQ(picture.rgb.size(), size_t(3) * kSize.x * kSize.y);
        EXPECT_TRUE(std::equal(picture.rgb.begin(), picture.rgb.end(), server.begin())) << coloured;
        EXPECT_GT(*std::ranges::max_element(picture.rgb) - *std::ranges::min_element(picture.rgb), 50) << "a picture";
    }
}

TEST_F(GpuTest, LitParticlesWhoseColdAlbedoIsNothingAreRefused) {
    Scene scene = sceneWithAll();
    scene.medium.emission = {1, 2, 3};
    const Message message = messageOf(device(), scene, Simulation(scene));
    client::LitReader reader;
    ASSERT_NE(reader.read(message.lit(), message.parsed.jpeg), nullptr) << reader.why();
    ASSERT_NE(message.lit().cold_albedo(), nullptr);
    *const_cast<wire::Vec3*>(message.lit().cold_albedo()) = wire::Vec3(1, 0, 1); // in the message's own bytes
    EXPECT_EQ(reader.read(message.lit(), message.parsed.jpeg), nullptr);
    EXPECT_EQ(reader.why(), "lit particles whose cold_albedo is not above 0");
}

} // namespace
} // namespace brume::test::drawn_scene_test
