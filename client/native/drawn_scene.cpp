#include "client/native/drawn_scene.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "common/phase_lobes.h"
#include "server/encode/rgb.h"
#include "server/methods/plans.h"
#include "server/plan/planner.h"
#include "server/render/renderer.h"

namespace brume::client {
namespace {

glm::vec3 vec(const wire::Vec3& v) { return {v.x(), v.y(), v.z()}; }

// The settings of a phase function with these numbers (common/phase_lobes.h).
PhaseSettings phaseOf(const flatbuffers::Vector<float>& numbers) {
    const float part = numbers.Get(0), asymmetry = numbers.Get(1), draine = numbers.Get(2), second = numbers.Get(3);
    PhaseSettings phase{.anisotropy = part, .asymmetry = asymmetry, .second_asymmetry = second};
    if (draine == 0) {
        phase.phase = second == 0 ? kMixturePhase : kDoublePhase;
    } else if (asymmetry == 0) {
        phase.phase = kRayleighPhase;
    } else {
        phase.phase = kDropletPhase; // its part tells the diameter
        phase.droplet = std::clamp(0.641583f - 0.599085f / (std::log(part) + 0.665888f), 5.0f, 50.0f);
    }
    return phase;
}

// What makes another renderer necessary.
bool sameObjects(const Scene& a, const Scene& b) {
    return a.planes == b.planes && a.boxes == b.boxes && a.spheres == b.spheres;
}
bool sameMedium(const Scene& a, const Scene& b) {
    const Medium &m = a.medium, &n = b.medium;
    return m.falloff == n.falloff && lobesOf(m) == lobesOf(n) && m.extinction_colour == n.extinction_colour &&
           m.emission == n.emission && m.cold_albedo == n.cold_albedo;
}
bool sameLight(const Scene& a, const Scene& b) {
    const Light &l = a.lights.front(), &o = b.lights.front();
    return l.to_light == o.to_light && l.irradiance == o.irradiance && a.sky.zenith == b.sky.zenith &&
           a.sky.horizon == b.sky.horizon && a.sky.ambient == b.sky.ambient && a.sky.haze == b.sky.haze &&
           a.render.exposure == b.render.exposure && a.render.tone_map == b.render.tone_map &&
           a.render.scattering == b.render.scattering;
}

} // namespace

Scene sceneOf(const wire::LitParticles& m, uint32_t count) {
    Scene scene;
    scene.name = "drawn";
    static_cast<PhaseSettings&>(scene.medium) = phaseOf(*m.phase());
    scene.medium.layout = Layout::live;
    scene.medium.count = std::max(count, 1u);
    scene.medium.falloff = m.falloff();
    for (const wire::Hue* hue : *m.hues())
        for (int c = 0; c < 3; ++c)
            if (hue->channels() >> c & 1) scene.medium.extinction_colour[c] = hue->extinction();
    if (m.emission() && m.cold_albedo())
        scene.medium.emission = vec(*m.emission()), scene.medium.cold_albedo = vec(*m.cold_albedo());
    Light sun;
    sun.to_light = vec(*m.to_light());
    sun.irradiance = vec(*m.irradiance());
    scene.lights = {sun};
    scene.sky.zenith = vec(*m.zenith());
    scene.sky.horizon = vec(*m.horizon());
    scene.sky.ambient = vec(*m.ambient());
    scene.sky.haze = m.haze();
    scene.render.exposure = m.exposure();
    scene.render.tone_map = m.filmic() ? "filmic" : "linear";
    if (m.objects())
        for (const wire::Object* o : *m.objects()) {
            const glm::vec3 centre = vec(o->centre()), half = vec(o->half_size()), albedo = vec(o->albedo());
            if (o->kind() == wire::ObjectKind::plane)
                scene.planes.push_back({centre.y, albedo, half.x, half.y});
            else if (o->kind() == wire::ObjectKind::box)
                scene.boxes.push_back({centre, 2.0f * half, o->yaw(), albedo});
            else
                scene.spheres.push_back({centre, half.x, albedo});
        }
    return scene;
}

struct DrawnScene::Stage {
    explicit Stage(const gpu::DeviceOptions& options) : device(options), submission(device, "drawn") {}

    gpu::Device device;
    Submission submission;
    Scene scene;
    std::optional<Simulation> simulation;
    std::optional<Renderer> renderer; // null: another scene was taken since
    std::optional<RenderSettings> settings;
    glm::vec3 planned_from{0};
    std::string name;
};

DrawnScene::DrawnScene() try : stage_(std::make_unique<Stage>(gpu::DeviceOptions())) {
    stage_->name = stage_->device.name();
} catch (const std::exception& error) {
    throw std::runtime_error(std::string("this machine cannot draw by itself: ") + error.what());
}
DrawnScene::~DrawnScene() = default;

const std::string& DrawnScene::device() const { return stage_->name; }

void DrawnScene::take(const wire::LitParticles& message, const lit::Rows& rows) {
    Stage& s = *stage_;
    const uint32_t room = s.simulation ? s.scene.medium.count : 0;
    Scene scene = sceneOf(message, std::max(room, std::bit_ceil(rows.count)));
    if (!rows.columns[lit::kFluence].empty()) scene.render.scattering = "propagation";
    const bool same = s.simulation && scene.medium.count == room && sameObjects(scene, s.scene) &&
                      sameMedium(scene, s.scene) && sameLight(scene, s.scene);
    if (!same) {
        s.renderer.reset();
        s.settings.reset();
        s.scene = std::move(scene);
        s.simulation.emplace(s.scene);
    }
    const auto number = [&](uint32_t column, uint32_t row) {
        return rows.columns[column].empty() ? uint16_t(0) : rows.columns[column][row];
    };
    std::vector<Command> commands;
    const glm::vec3 origin = vec(*message.origin());
    for (uint32_t first = 0; first < rows.count; first += kMostRows) {
        auto part = std::make_shared<ParticleRows>();
        for (uint32_t row = first; row < std::min<uint32_t>(rows.count, first + kMostRows); ++row) {
            const auto each = [&](uint32_t column) {
                return glm::vec3(number(column, row), number(column + 1, row), number(column + 2, row));
            };
            part->positions.push_back(origin + message.step() * each(lit::kPlace));
            part->scales.push_back(lit::ofLogCode(number(lit::kScale, row)));
            part->extinctions.push_back(lit::ofLogCode(number(lit::kExtinction, row)));
            part->albedos.push_back(each(lit::kAlbedo) / 65535.0f);
        }
        commands.push_back({.body = SetParticles{first, rows.count, 0, std::move(part)}});
    }
    if (rows.count == 0) commands.push_back({.body = SetParticles{}});
    s.simulation->step(commands);
}

void DrawnScene::draw(const Pose& eye, uint32_t width, uint32_t height, Picture& out) {
    Stage& s = *stage_;
    if (!s.renderer) s.renderer.emplace(s.device, s.scene, s.simulation->capacity());
    // Another plan when the eye has moved by a tenth of its distance.
    const float distance = glm::distance(eye.position, 0.5f * (s.simulation->bounds().lo + s.simulation->bounds().hi));
    if (!s.settings || glm::distance(eye.position, s.planned_from) > 0.1f * distance) {
        PlanInputs inputs{.scene = planScene(s.scene, *s.simulation), .methods = allMethods()};
        inputs.views = {{eye, width, height}};
        s.settings = makePlan(inputs, builtInCosts()).chosen.settings;
        s.planned_from = eye.position;
    }
    const EyeRequest request{eye, width, height};
    try {
        s.renderer->submit(s.submission, *s.simulation, {&request, 1}, &*s.settings, true);
        while (!s.submission.commands.wait(1'000'000'000)) {
        }
    } catch (const gpu::Error& error) {
        throw std::runtime_error(std::string("this machine cannot draw by itself: ") + error.what());
    }
    out.width = int(width), out.height = int(height);
    packRgb(s.submission.pictures().front(), out.rgb);
    out.rgb.resize(size_t{3} * width * height);
}

} // namespace brume::client
