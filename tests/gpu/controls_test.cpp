// The controls of figure 14 of seed 000 (docs/results/seed-000.md), each changed on a running simulation that a
// renderer draws: what it changes, and that nothing else changes. Who may change them is told by settings_test.cpp.
#include <gtest/gtest.h>

#include "shaders/shared/show.h"
#include "tests/gpu/fixture.h"

namespace brume::test::controls_test {
namespace {

constexpr uint32_t kWidth = 64, kHeight = 48;
const Pose kPose = lookAt({1, 2, 14}, {0, 0, 0}, 0.7f);

Scene startScene() {
    Scene scene;
    scene.medium.count = 60;
    scene.medium.extent = 5;
    scene.medium.scale = {3, 3};
    scene.medium.extinction = 400;
    scene.medium.anisotropy = 0.5f;
    scene.medium.asymmetry = 0.3f;
    scene.lights = {{.to_light = glm::normalize(glm::vec3(0.5f, 0.8f, 0.3f)), .irradiance = glm::vec3(5)}};
    scene.sky = {.zenith = glm::vec3(0), .horizon = glm::vec3(0)};
    scene.boxes = {{.centre = {0.5f, 4, 0}, .size = {1, 0.5f, 1}}};
    scene.spheres = {{.centre = {-1, 4, 1}, .radius = 0.5f}};
    scene.simulation.paused = true;
    scene.render.method = "isv";
    scene.render.shadow_size = 64, scene.render.opaque_shadow_size = 256;
    return scene;
}

// A simulation that takes commands, and its picture.
class Running {
public:
    Running(const gpu::Device& device, const Scene& scene)
        : simulation_(scene), renderer_(device, scene, simulation_.capacity()), submission_(device, "controls") {
        renderer_.keepRadiance(true);
        step();
    }
    void step(std::vector<CommandBody> bodies = {}) {
        std::vector<Command> commands;
        for (CommandBody& body : bodies) commands.push_back({1, 1, std::move(body)});
        simulation_.step(commands);
        for (const RefusedCommand& refused : simulation_.refused()) ADD_FAILURE() << refused.why;
    }
    std::vector<glm::vec4> see(const Pose& pose = kPose, uint32_t show = gpu::kShowPicture) {
        EyeRequest eye{pose, kWidth, kHeight};
        eye.show = show;
        submitAndWait(renderer_, submission_, simulation_, {&eye, 1});
        const PictureView& picture = submission_.pictures().front();
        bytes_.assign(picture.bytes, picture.bytes + picture.layout.bytes());
        return renderer_.readRadiance();
    }
    const std::vector<uint8_t>& bytes() const { return bytes_; } // what viewers got last
    std::vector<gpu::Particle> particles() const {
        std::vector<gpu::Particle> all(simulation_.liveCount());
        simulation_.write(all);
        return all;
    }
    const SceneNow& now() const { return simulation_.now(); }

private:
    Simulation simulation_;
    Renderer renderer_;
    Submission submission_;
    std::vector<uint8_t> bytes_;
};

class ControlsTest : public GpuTest {
protected:
    // Relative RMSE of light and transmittance.
    static double difference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
        double off = 0, all = 0;
        for (size_t i = 0; i < a.size(); ++i) {
            const glm::dvec4 p(a[i]), q(b[i]);
            off += glm::dot(p - q, p - q), all += glm::dot(q, q);
        }
        return std::sqrt(off / all);
    }
};

// A picture after a setting is that of a scene which begins with it, and another one than before; set back, it is the
// picture from before. All but for roundings: a light's map keeps axes of its own, which depend on where it was.
TEST_F(ControlsTest, SettingsMakeThePictureOfASceneThatHasThem) {
    const auto medium = [](auto member, auto value) { return [=](Scene& s) { s.medium.*member = value; }; };
    const auto isv = [](auto member, auto value) { return [=](Scene& s) { s.render.isv.*member = value; }; };
    const auto light = [](auto member, auto value) { return [=](Scene& s) { s.lights[0].*member = value; }; };
    const glm::vec3 low = glm::normalize(glm::vec3(-0.6f, 0.5f, 0.2f)), box(-0.5f, 3.5f, 0.5f), ball(1, 3, 0.5f);
    const struct {
        const char* path;
        SettingValue value;
        std::function<void(Scene&)> in_scene;
    } controls[] = {
        {"medium.albedo", glm::vec3(0.9f, 0.5f, 0.1f), medium(&Medium::albedo, glm::vec3(0.9f, 0.5f, 0.1f))},
        {"medium.extinction", 800.0f, medium(&Medium::extinction, 800.0f)},
        {"medium.falloff", 2.5f, medium(&Medium::falloff, 2.5f)},
        {"medium.anisotropy", 1.0f, medium(&Medium::anisotropy, 1.0f)},
        {"medium.asymmetry", -0.6f, medium(&Medium::asymmetry, -0.6f)},
        {"light.to_light", low, light(&Light::to_light, low)},
        {"light.irradiance", glm::vec3(2, 3, 4), light(&Light::irradiance, glm::vec3(2, 3, 4))},
        {"box[0].centre", box, [=](Scene& s) { s.boxes[0].centre = box; }},
        {"sphere[0].centre", ball, [=](Scene& s) { s.spheres[0].centre = ball; }},
        {"render.isv.quadrature", std::string("analytic"), isv(&IsvSettings::quadrature, "analytic")},
        {"render.isv.steps", 5u, isv(&IsvSettings::steps, 5u)},
        {"render.isv.fading", false, isv(&IsvSettings::fading, false)},
        {"render.isv.soft_shadows", true, isv(&IsvSettings::soft_shadows, true)},
        {"render.isv.multiple", 0.5f, isv(&IsvSettings::multiple, 0.5f)},
        {"render.method", std::string("slabs"), [](Scene& s) { s.render.method = "slabs"; }},
    };
    const Scene start = startScene();
    Running running(device(), start);
    const std::vector<glm::vec4> before = running.see();
    for (const auto& control : controls) {
        SceneNow was = running.now();
        SettingValue old = std::string(control.path) == "box[0].centre" ? SettingValue(start.boxes[0].centre)
                           : std::string(control.path) == "sphere[0].centre"
                               ? SettingValue(start.spheres[0].centre)
                               : valueOf(*liveSetting(control.path), partsOf(was));
        running.step({Set{Change(control.path, control.value)}});
        const std::vector<glm::vec4> picture = running.see();
        Scene other = start;
        control.in_scene(other);
        const double changed = difference(picture, before), off = difference(picture, Running(device(), other).see());
        EXPECT_GT(changed, 1e-4) << control.path;
        EXPECT_LE(off, 1e-6) << control.path;
        running.step({Set{Change(control.path, old)}});
        const double back = difference(running.see(), before);
        EXPECT_LE(back, 1e-6) << control.path << ", set back";
        std::printf("%-24s changes %.1e; off by %.1e, set back %.1e\n", control.path, changed, off, back);
    }
}

// What another scene changes: as many particles, and extinctions and sizes of its ranges.
TEST_F(ControlsTest, CountScaleAndMultiplierAreThoseOfTheScene) {
    Scene scene = startScene();
    scene.medium.count = 500;
    scene.medium.scale = {2, 4};
    scene.medium.multiplier = {20, 40};
    const std::vector<gpu::Particle> particles = Running(device(), scene).particles();
    ASSERT_EQ(particles.size(), 500u);
    const auto isUniformIn = [&](double lo, double hi, const auto& value, const char* what) {
        double least = 1e30, most = 0, sum = 0;
        for (const gpu::Particle& p : particles)
            least = std::min(least, value(p)), most = std::max(most, value(p)), sum += value(p);
        // Of 500 uniform numbers the mean errs by 0.013 of the range, and the extremes by 1/500.
        EXPECT_NEAR(sum / 500, (lo + hi) / 2, 4 * 0.013 * (hi - lo)) << what;
        EXPECT_TRUE(least >= lo * (1 - 1e-6) && least < lo + 0.02 * (hi - lo)) << what << ' ' << least;
        EXPECT_TRUE(most <= hi * (1 + 1e-6) && most > hi - 0.02 * (hi - lo)) << what << ' ' << most;
    };
    isUniformIn(
        2, 4, [](const gpu::Particle& p) { return double(p.scale); }, "scale");
    // The peak is extinction * multiplier * 1e-4.
    isUniformIn(
        0.8, 1.6, [](const gpu::Particle& p) { return double(p.sigma_t); }, "extinction");
    // Twice the multiplier is twice the optical depth of every pixel.
    Scene thin = startScene(), thick = thin;
    thin.boxes.clear(), thin.spheres.clear(), thick.boxes.clear(), thick.spheres.clear();
    thin.render.cutoff = thick.render.cutoff = 1e-6f;
    thick.medium.multiplier = {2 * thin.medium.multiplier.lo, 2 * thin.medium.multiplier.hi};
    const std::vector<glm::vec4> one = Running(device(), thin).see(), two = Running(device(), thick).see();
    int seen = 0;
    for (size_t i = 0; i < one.size(); ++i) {
        const double depth = -std::log(double(one[i].a));
        if (depth < 0.05 || depth > 3) continue;
        EXPECT_NEAR(-std::log(double(two[i].a)), 2 * depth, 1e-3 * depth) << i;
        ++seen;
    }
    EXPECT_GT(seen, 300);
}

TEST_F(ControlsTest, MoveVolumeMovesEveryParticleAndThePicture) {
    Scene scene = startScene();
    scene.boxes.clear(), scene.spheres.clear();
    Running running(device(), scene);
    const std::vector<gpu::Particle> before = running.particles();
    const std::vector<glm::vec4> seen = running.see();
    const glm::vec3 offset(3, -1, 0.5f);
    running.step({Set{Change("simulation.paused", false)}, MoveVolume{offset}});
    const auto meanOff = [&] {
        glm::vec3 sum(0);
        for (const gpu::Particle& p : running.particles()) sum += p.centre;
        for (const gpu::Particle& p : before) sum -= p.centre;
        return sum / float(before.size());
    };
    EXPECT_LT(glm::length(meanOff()), 0.5f * glm::length(offset))
        << "springs pull particles there, nothing throws them";
    for (int i = 0; i < 600; ++i) running.step(); // e^-7.5 of the way is left, or less
    EXPECT_LT(glm::length(meanOff() - offset), 0.01f);
    // From as far away in the other direction the medium looks as before.
    const std::vector<glm::vec4> there = running.see();
    Pose along = kPose;
    along.position += offset;
    const std::vector<glm::vec4> moved = running.see(along);
    double changed = 0, off = 0;
    for (size_t i = 0; i < seen.size(); ++i) {
        changed = std::max(changed, std::abs(double(there[i].a) - double(seen[i].a)));
        off = std::max(off, std::abs(double(moved[i].a) - double(seen[i].a)));
    }
    EXPECT_GT(changed, 0.3);
    EXPECT_LT(off, 0.01);
}

// Particles near the ray move away from it, those farther than the radius stay as they were.
TEST_F(ControlsTest, ImpulsePushesParticlesNearItsRay) {
    Scene scene = startScene();
    scene.simulation.paused = false;
    scene.simulation.impulse_radius = 1.5f;
    Running running(device(), scene), rest(device(), scene);
    const Impulse impulse{.origin = {0, 0, 14}, .direction = {0, 0, -1}};
    const std::vector<gpu::Particle> start = running.particles();
    running.step({impulse});
    rest.step();
    for (int i = 0; i < 6; ++i) running.step(), rest.step();
    const std::vector<gpu::Particle> pushed = running.particles(), others = rest.particles();
    int near = 0, far = 0;
    for (size_t i = 0; i < start.size(); ++i) {
        const float apart = glm::length(glm::vec2(start[i].centre));
        if (apart > scene.simulation.impulse_radius * 1.01f) {
            EXPECT_EQ(pushed[i].centre, others[i].centre) << i;
            ++far;
        } else if (apart < 0.9f * scene.simulation.impulse_radius) {
            EXPECT_GT(glm::length(glm::vec2(pushed[i].centre)), glm::length(glm::vec2(others[i].centre))) << i;
            ++near;
        }
    }
    EXPECT_GT(near, 5);
    EXPECT_GT(far, 20);
    EXPECT_TRUE(running.see() != rest.see());
}

// A pause keeps places and the turning light; without it a light turns by its rate, and particles move.
TEST_F(ControlsTest, ALightTurnsUnlessThereIsAPause) {
    constexpr float kRate = 0.5f; // rad/s
    Scene scene = startScene();
    scene.simulation.volume_velocity = {0.5f, 0, 0};
    Running running(device(), scene);
    const glm::vec3 start = running.now().light.to_light;
    const std::vector<glm::vec4> before = running.see();
    running.step({Set{Change("light.rotate", kRate)}});
    for (int i = 0; i < 59; ++i) running.step();
    EXPECT_EQ(running.now().light.to_light, start);
    EXPECT_TRUE(running.see() == before);
    running.step({Set{Change("simulation.paused", false)}});
    for (int i = 0; i < 59; ++i) running.step(); // a second in all
    const glm::vec3 turned = running.now().light.to_light;
    EXPECT_NEAR(turned.y, start.y, 1e-5f);
    const auto angle = [](glm::vec3 v) { return std::atan2(-v.z, v.x); }; // about +Y
    EXPECT_NEAR(angle(turned) - angle(start), kRate, 1e-4f);
    EXPECT_TRUE(running.see() != before);
}

// A viewer's view shows the wasted part, and leaves the scene as it is.
TEST_F(ControlsTest, TheViewOfWastedPixelsIsAnotherPicture) {
    Running running(device(), startScene());
    running.see();
    const std::vector<uint8_t> picture = running.bytes();
    running.see(kPose, gpu::kShowWasted);
    EXPECT_TRUE(running.bytes() != picture);
    running.see();
    EXPECT_TRUE(running.bytes() == picture);
}

} // namespace
} // namespace brume::test::controls_test
